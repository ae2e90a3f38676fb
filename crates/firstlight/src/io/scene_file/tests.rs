use super::*;
use std::path::Path;
#[test]
fn dump() {
    let access = FileAccess::beside(Path::new("/tmp/c/scene.toml"), &[]);
    for line in std::fs::read_to_string("/tmp/c/wrong.txt").unwrap().lines() {
        let text = line.replace("\\n", "\n");
        match read(&text, "s.toml", &[], &access, &mut vec![]) {
            Ok(_) => println!("-- {line}\nOK?!"),
            Err(e) => println!("-- {line}\n{e}"),
        }
    }
    for o in [
        "film.samples=0",
        "film.smaples=4",
        "lights.key.point.power=60W",
        "background=#fff9be",
        "background=rd",
        "camera.perspective.fov=[1",
        "x",
        "film.samples.a=3",
        "surfaces.b.transform.0.scale=0",
        "surfaces.b.transform.7.scale=0",
        "\"a=b\".c=1",
        "lights.key.point.power=60 lx",
        "film={samples=3,x=2}",
        "lights.kye.point.power=3",
    ] {
        let text = "[lights.key.point]\nposition=[0,0,1]\npower=3\n[surfaces.b]\nsphere={}\ntransform=[{scale=1}]\n[film]\nsamples=3\n";
        let r =
            o.parse::<Override>().and_then(|o| read(text, "s.toml", &[o], &access, &mut vec![]));
        println!("== {o}\n{}", r.map_or_else(|e| e.to_string(), |_| "ok".into()));
    }
}
