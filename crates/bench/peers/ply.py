"""Triangle meshes as PLY files: what the recipes write, and what programs without a reader of their own are given."""

import numpy as np

TYPES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4", "double": "f8",
    "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4", "float32": "f4",
    "float64": "f8",
}


def save(path, vertices, triangles):
    """Writes a binary file: vertices (n, 3), triangles (m, 3)."""
    faces = np.empty(len(triangles), [("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, triangles
    with open(path, "wb") as out:
        out.write(
            f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\nproperty float x\nproperty float y\n"
            f"property float z\nelement face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n".encode()
        )
        np.asarray(vertices, "<f4").tofile(out)
        faces.tofile(out)


def load(path):
    """Vertices (n, 3) and triangles (m, 3) of a file whose faces are all triangles."""
    with open(path, "rb") as file:
        form, elements = header(file)
        if form == "ascii":
            return load_text(file, elements)
        order = "<" if form == "binary_little_endian" else ">"
        (vertex_count, vertex_properties), (face_count, _) = elements["vertex"], elements["face"]
        vertex = np.dtype([(words[-1], order + TYPES[words[0]]) for words in vertex_properties])
        vertices = np.frombuffer(file.read(vertex.itemsize * vertex_count), vertex)
        faces = np.frombuffer(file.read(), face_type(elements, order), face_count)
    check(faces["count"])
    return np.stack([vertices[axis] for axis in "xyz"], 1).astype(np.float32), faces["corners"].astype(np.uint32)


def header(file):
    """The format, and for each element its count and properties, as words."""
    form, elements, words = None, {}, file.readline().split()
    while words != ["end_header"]:
        words = file.readline().decode("latin1").split()
        if words[0] == "format":
            form = words[1]
        elif words[0] == "element":
            properties = []
            elements[words[1]] = (int(words[2]), properties)
        elif words[0] == "property":
            properties.append(words[1:])
    return form, elements


def face_type(elements, order):
    """How one triangle lies in a binary file."""
    [(kind, count, index, _name)] = elements["face"][1]
    assert kind == "list", "faces must be lists of corners and nothing else"
    return np.dtype([("count", order + TYPES[count]), ("corners", order + TYPES[index], 3)])


def load_text(file, elements):
    (vertex_count, properties), (face_count, _) = elements["vertex"], elements["face"]
    numbers = np.array(file.read().split(), np.float64)
    width = len(properties)
    vertices = numbers[: vertex_count * width].reshape(vertex_count, width)
    columns = [[words[-1] for words in properties].index(axis) for axis in "xyz"]
    faces = numbers[vertex_count * width :][: 4 * face_count].reshape(face_count, 4)
    check(faces[:, 0])
    return vertices[:, columns].astype(np.float32), faces[:, 1:].astype(np.uint32)


def check(counts):
    assert (counts == 3).all(), "all faces must be triangles"


def bumpy_ball(triangles):
    """A ball of radius 1, y up, with waves of three sizes; about so many triangles."""
    rows = max(4, round((triangles / 4) ** 0.5))
    columns = 2 * rows
    theta, phi = np.meshgrid(np.pi * np.arange(rows + 1) / rows, 2 * np.pi * np.arange(columns) / columns, indexing="ij")
    waves = 0.05 * np.sin(11 * theta) * np.cos(13 * phi) + 0.02 * np.cos(47 * theta) * np.sin(59 * phi)
    radius = 1 + np.sin(theta) * (waves + 0.006 * np.sin(181 * theta + 3 * np.sin(29 * phi)))
    out = np.stack([np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi)], -1)
    row, column = np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij")
    a, b = row * columns + column, row * columns + (column + 1) % columns
    c, d = b + columns, a + columns
    upper, lower = np.stack([a, b, c], -1)[1:], np.stack([a, c, d], -1)[:-1]
    return (radius[..., None] * out).reshape(-1, 3), np.concatenate([upper.reshape(-1, 3), lower.reshape(-1, 3)])
