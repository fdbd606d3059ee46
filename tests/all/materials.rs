//! Materials with their libraries and images: those that an OBJ refers to, and those embedded in a GLB.

use spectral_remesh::io::Format;
use spectral_remesh::io::file::{read_file, write_file};
use spectral_remesh::stages::mesh::attributes::Attributes;
use spectral_remesh::stages::mesh::materials::{Alpha, Image, Look, Material, Materials, Sampler, Texture, Use};
use spectral_remesh::stages::mesh::parts::Parts;
use std::fs;
use std::path::Path;

const OBJ: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n\
                   usemtl wood\nf 1/1 2/2 3/3\nusemtl glass\nf 3/3 2/2 1/1\n";
const MTL: &str = "newmtl wood\nNs 100\nmap_Kd -s 2 2 2 images\\my wood.png\nnewmtl glass\nd 0.5\n";
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n1234";

/// Returns a folder with an OBJ, its material library, its image, and a folder to write to.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for name in ["in/images", "out/deep"] {
        fs::create_dir_all(folder.path().join(name)).unwrap();
    }
    for (name, content) in [("in/a.obj", OBJ.as_bytes()), ("in/a.mtl", MTL.as_bytes()), ("in/images/my wood.png", PNG)]
    {
        fs::write(folder.path().join(name), content).unwrap();
    }
    folder
}

/// Reads `from`, writes its content to `to`, and returns the attributes and notes of `from`.
fn converted(folder: &Path, from: &str, to: &str) -> (Attributes, Vec<String>) {
    let loaded = read_file(&folder.join(from), None).unwrap();
    write_file(&folder.join(to), &loaded.mesh, &loaded.attributes, None).unwrap();
    (loaded.attributes, loaded.notes)
}

fn look(attributes: &Attributes, material: usize) -> &Look {
    attributes.materials.as_ref().unwrap().list[material].look.as_ref().unwrap()
}

#[test]
fn a_library_goes_with_its_mesh_and_images_are_still_found() {
    let folder = folder();
    let (attributes, notes) = converted(folder.path(), "in/a.obj", "out/deep/b.obj");
    assert!(notes.is_empty(), "{notes:?}");
    assert_eq!((look(&attributes, 0).textures.len(), look(&attributes, 1).alpha), (1, Alpha::Blend));
    let text = |name: &str| fs::read_to_string(folder.path().join("out/deep").join(name)).unwrap();
    assert!(text("b.obj").starts_with("mtllib b.mtl\n"));
    assert_eq!(
        text("b.mtl"),
        "newmtl wood\nNs 100\nmap_Kd -s 2 2 2 ../../in/images/my wood.png\n\nnewmtl glass\nd 0.5\n\n"
    );
    let again = read_file(&folder.path().join("out/deep/b.obj"), None).unwrap();
    assert_eq!((again.notes, look(&again.attributes, 0)), (vec![], look(&attributes, 0)));
}

#[test]
fn images_get_into_glb_and_out_of_it() {
    let folder = folder();
    converted(folder.path(), "in/a.obj", "out/b.glb");
    let (attributes, _) = converted(folder.path(), "out/b.glb", "out/c.obj.gz");
    assert_eq!(attributes.materials.unwrap().images, [Image::Bytes(PNG.into())]);
    assert_eq!(fs::read(folder.path().join("out/c-0.png")).unwrap(), PNG);
    assert!(fs::read_to_string(folder.path().join("out/c.mtl")).unwrap().contains("map_Kd c-0.png\n"));
    let last = read_file(&folder.path().join("out/c.obj.gz"), None).unwrap();
    assert_eq!((last.notes, look(&last.attributes, 0).textures.len()), (vec![], 1));
}

#[test]
fn what_is_not_there_is_said_and_stays_named() {
    let folder = folder();
    fs::remove_file(folder.path().join("in/images/my wood.png")).unwrap();
    let (_, notes) = converted(folder.path(), "in/a.obj", "in/b.glb");
    assert_eq!(notes, ["the image 'images\\\\my wood.png' does not exist"]);
    fs::remove_file(folder.path().join("in/a.mtl")).unwrap();
    let (_, notes) = converted(folder.path(), "in/a.obj", "in/b.obj");
    assert_eq!(notes, ["the material library cannot be read: the file 'a.mtl' cannot be read: there is no such file"]);
    assert!(fs::read_to_string(folder.path().join("in/b.obj")).unwrap().starts_with("mtllib a.mtl\n"));
    assert!(!folder.path().join("in/b.mtl").exists());
    fs::write(folder.path().join("in/a.obj"), OBJ.replace("a.mtl", "../a.mtl")).unwrap();
    let (_, notes) = converted(folder.path(), "in/a.obj", "in/b.obj");
    assert!(notes[0].contains("'../a.mtl' is outside the folder"), "{notes:?}");
}

#[test]
fn formats_say_what_of_materials_they_lose() {
    let texture = |of, image| Texture { of, image, strength: 1.0, sampler: Sampler::default(), transform: None };
    let textures = vec![texture(Use::Occlusion, 0), texture(Use::BaseColor, 1)];
    let look = Some(Look { textures, ..Look::default() });
    let list = vec![Material { name: "a".into(), look }];
    let images = vec![Image::Bytes(PNG.into()), Image::File("a.tga".into())];
    let materials = Some(Materials { list, images, ..Materials::default() });
    let parts = Some(Parts::default());
    let attributes = Attributes { materials, parts, ..Attributes::default() };
    let lost = |format: Format| format.cannot_hold(&attributes).into_iter().map(|l| l.name).collect::<Vec<_>>();
    assert_eq!(lost(Format::Obj), ["textures for roughness, metalness and occlusion"]);
    assert_eq!(lost(Format::Glb), ["images that are neither PNG nor JPEG"]);
    assert_eq!(lost(Format::Stl), ["materials", "names of objects"]);
}
