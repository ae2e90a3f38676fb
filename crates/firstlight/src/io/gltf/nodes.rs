//! The node tree: which nodes are in the scene, and where.

use super::data::Data;
use super::document::Node;
use crate::diagnostic::Result;
use glam::{DAffine3, DMat4, DQuat, DVec3};
use std::iter::Enumerate;
use std::slice::Iter;

/// A node in the world.
pub(super) struct Placed<'a> {
    /// The node.
    pub(super) node: &'a Node,
    /// Its index in the document.
    pub(super) index: u32,
    /// From its own space to the world; finite.
    pub(super) transform: DAffine3,
}

/// The nodes of the scene that show something, parents before children: of the default scene, else the first,
/// else of all.
///
/// # Errors
/// If a node does not exist, is reached twice or has a transform that is not finite and affine.
pub(super) fn place<'a>(data: &Data<'a>) -> Result<Vec<Placed<'a>>> {
    let parents = vec![None; data.document.nodes.len()];
    let mut tree = Tree { data, parents, placed: Vec::new() };
    for (root, parent) in roots(data)? {
        tree.walk(root, parent)?;
    }
    Ok(tree.placed)
}

struct Tree<'a, 'd> {
    data: &'d Data<'a>,
    /// From where each node was reached.
    parents: Vec<Option<Parent>>,
    placed: Vec<Placed<'a>>,
}

/// A node whose children are being visited.
struct Open<'a> {
    index: u32,
    children: Enumerate<Iter<'a, u32>>,
    transform: DAffine3,
}

impl<'a> Tree<'a, '_> {
    /// Visits a root and all below it, without recursion: the depth of the tree is the file's choice.
    fn walk(&mut self, root: u32, parent: Parent) -> Result<()> {
        let mut open = vec![self.enter(root, parent, DAffine3::IDENTITY)?];
        while let Some(node) = open.last_mut() {
            match node.children.next() {
                Some((i, &child)) => {
                    let (parent, above) = (Parent::Node(node.index, i), node.transform);
                    open.push(self.enter(child, parent, above)?);
                }
                None => drop(open.pop()),
            }
        }
        Ok(())
    }

    fn enter(&mut self, index: u32, parent: Parent, above: DAffine3) -> Result<Open<'a>> {
        let data = self.data;
        let node = data.at(&data.document.nodes, index, "node", &parent.part())?;
        if let Some(slot) = self.parents.get_mut(index as usize)
            && let Some(first) = slot.replace(parent)
        {
            let cause = format!(
                "node {index} is reached again, first from {}; a node must have one parent",
                first.part()
            );
            return Err(data.error(parent.part(), cause));
        }
        let transform = above * local(data, node, index)?;
        if !transform.is_finite() {
            let cause = "its transform in the world is not a finite number";
            return Err(data.error(format!("nodes[{index}]"), cause));
        }
        if node.mesh.is_some() || node.camera.is_some() || node.extensions.is_some() {
            self.placed.push(Placed { node, index, transform });
        }
        Ok(Open { index, children: node.children.iter().enumerate(), transform })
    }
}

/// From where a node was reached.
#[derive(Clone, Copy)]
enum Parent {
    /// A scene's list, and the place in it.
    Scene(u32, usize),
    /// A node's list of children, and the place in it.
    Node(u32, usize),
    /// Nothing refers to it.
    None,
}

impl Parent {
    fn part(self) -> String {
        match self {
            Self::Scene(scene, place) => format!("scenes[{scene}].nodes[{place}]"),
            Self::Node(node, place) => format!("nodes[{node}].children[{place}]"),
            Self::None => "nodes".into(),
        }
    }
}

fn roots(data: &Data) -> Result<Vec<(u32, Parent)>> {
    let document = data.document;
    if document.scene.is_none() && document.scenes.is_empty() {
        return orphans(data);
    }
    let index = document.scene.unwrap_or(0);
    let scene = data.at(&document.scenes, index, "scene", "scene")?;
    let places = scene.nodes.iter().enumerate();
    Ok(places.map(|(i, &node)| (node, Parent::Scene(index, i))).collect())
}

/// The nodes that are nobody's child.
fn orphans(data: &Data) -> Result<Vec<(u32, Parent)>> {
    let nodes = &data.document.nodes;
    let mut is_child = vec![false; nodes.len()];
    for child in nodes.iter().flat_map(|node| &node.children) {
        is_child.get_mut(*child as usize).into_iter().for_each(|is_child| *is_child = true);
    }
    let roots: Vec<_> =
        (0..).zip(is_child).filter(|(_, child)| !child).map(|(i, _)| (i, Parent::None)).collect();
    if roots.is_empty() && !nodes.is_empty() {
        return Err(data.error("nodes", "every node is a child of another; there is no root"));
    }
    Ok(roots)
}

/// A node's own transform, relative to its parent.
fn local(data: &Data, node: &Node, index: u32) -> Result<DAffine3> {
    if let Some(matrix) = &node.matrix {
        let matrix = DMat4::from_cols_array(matrix);
        if matrix.row(3).to_array() != [0.0, 0.0, 0.0, 1.0] {
            let cause = "the last row of a matrix must be 0 0 0 1";
            return Err(data.error(format!("nodes[{index}].matrix"), cause));
        }
        return Ok(DAffine3::from_mat4(matrix));
    }
    let translation = node.translation.as_deref().copied().unwrap_or_default();
    let scale = node.scale.as_deref().copied().unwrap_or([1.0; 3]);
    let rotation = node.rotation.as_deref().copied().unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let Some(rotation) = unit_quaternion(rotation) else {
        let cause = "a rotation must be a unit quaternion; this one has no usable length";
        return Err(data.error(format!("nodes[{index}].rotation"), cause));
    };
    Ok(DAffine3::from_scale_rotation_translation(
        DVec3::from(scale),
        rotation,
        DVec3::from(translation),
    ))
}

/// A quaternion x, y, z, w made a rotation, unless it is zero or not finite.
pub(super) fn unit_quaternion(numbers: [f64; 4]) -> Option<DQuat> {
    let quaternion = DQuat::from_array(numbers);
    let length = quaternion.length();
    (length.is_finite() && length > 1e-6).then(|| quaternion.normalize())
}
