use super::files::*;
use crate::io::content::Read;
use crate::io::gltf;
use crate::mesh::attributes::Attributes;
use crate::mesh::materials::{Alpha, Image, Look, REPEAT, Sampler};
use serde_json::{Value, json};

/// The start of a PNG file.
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n1234";

/// A square of two triangles in two primitives, the first of which has texture coordinates and a material with all supported
/// properties.
fn dressed() -> Value {
    let uv = [0.0f32, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0].map(f32::to_le_bytes);
    let mut root = with_data(&SQUARE, &[uv.as_flattened(), &[0, 1, 2, 2, 1, 3, 0, 0], PNG].concat());
    root["bufferViews"] = json!([
        { "buffer": 0, "byteLength": 48 }, { "buffer": 0, "byteOffset": 48, "byteLength": 32 },
        { "buffer": 0, "byteOffset": 80, "byteLength": 6 }, { "buffer": 0, "byteOffset": 88, "byteLength": 12 },
    ]);
    push(&mut root["accessors"], json!({ "bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2" }));
    for start in [0, 3] {
        let indices =
            json!({ "bufferView": 2, "byteOffset": start, "componentType": 5121, "count": 3, "type": "SCALAR" });
        push(&mut root["accessors"], indices);
    }
    root["meshes"] = json!([{ "name": "square", "primitives": [
        { "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "indices": 2, "material": 2 },
        { "attributes": { "POSITION": 0 }, "indices": 3, "material": 0 },
    ] }]);
    root["images"] = json!([{ "bufferView": 3, "mimeType": "image/png" }, { "uri": address(b"not an image") }]);
    root["samplers"] = json!([{ "wrapS": 33_071, "magFilter": 9728 }]);
    root["textures"] = json!([{ "source": 0, "sampler": 0 }, { "source": 1 }, { "sampler": 0 }]);
    let change = json!({ "KHR_texture_transform": { "offset": [0.5, 0.25], "scale": [2, 2] } });
    root["materials"] = json!([
        { "name": "plain", "pbrMetallicRoughness": { "baseColorFactor": [1, 0, 0, 0.5] }, "alphaMode": "BLEND" },
        { "name": "unused", "emissiveTexture": { "index": 77 } },
        {
            "name": "wood", "doubleSided": true, "alphaMode": "MASK", "alphaCutoff": 0.25, "emissiveFactor": [0, 0, 1],
            "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "metallicFactor": 0.25, "roughnessFactor": 0.75 },
            "normalTexture": { "index": 0, "scale": 2, "extensions": change },
            "extensions": { "KHR_materials_unlit": {} },
        },
    ]);
    root
}

fn look(attributes: &Attributes, material: usize) -> &Look {
    attributes.materials.as_ref().unwrap().list[material].look.as_ref().unwrap()
}

#[test]
fn materials_come_back_as_they_were() {
    let read = |bytes: &[u8]| gltf::parse(bytes, &no_files).unwrap();
    let first = read(dressed().to_string().as_bytes());
    assert!(first.notes.is_empty(), "{:?}", first.notes);
    let materials = first.attributes.materials.as_ref().unwrap();
    assert_eq!(materials.list.iter().map(|m| m.name.as_str()).collect::<Vec<_>>(), ["plain", "wood"]);
    assert_eq!((&materials.of_triangle[..], &materials.images[..]), (&[1, 0][..], &[Image::Bytes(PNG.into())][..]));
    let (plain, wood) = (look(&first.attributes, 0), look(&first.attributes, 1));
    assert_eq!((plain.base_color, plain.alpha), ([1.0, 0.0, 0.0, 0.5], Alpha::Blend));
    assert_eq!((wood.metallic, wood.roughness, wood.emissive), (0.25, 0.75, [0.0, 0.0, 1.0]));
    assert_eq!((wood.alpha, wood.double_sided, wood.unlit), (Alpha::Mask(0.25), true, true));
    assert_eq!(wood.textures.iter().map(|t| t.strength).collect::<Vec<_>>(), [1.0, 2.0]);
    assert_eq!(wood.textures[0].sampler, Sampler { mag_filter: Some(9728), min_filter: None, wrap: [33_071, REPEAT] });
    assert!(first.attributes.texture[0].iter().all(|at| at.is_finite()));
    // The primitive without texture coordinates gets none.
    assert!(first.attributes.texture[1][2].is_nan());
    assert_eq!(first.attributes.parts.as_ref().unwrap().list[0].object, "square");
    for format in [crate::io::Format::Glb, crate::io::Format::Gltf] {
        let mut bytes = Vec::new();
        crate::io::write_with_attributes(&first.mesh, &first.attributes, format, &mut bytes).unwrap();
        let second = read(&bytes);
        let of = |read: &Read| read.attributes.materials.clone().unwrap();
        assert_eq!((of(&second).list, of(&second).images), (of(&first).list, of(&first).images));
        let looks = |read: &Read| {
            let mut seen: Vec<_> =
                (0..2).map(|t| (of(read).of_triangle[t], read.mesh.corners(t).map(|p| p.to_array()))).collect();
            seen.sort_by_key(|(material, _)| *material);
            seen
        };
        assert_eq!(looks(&second), looks(&first));
        assert_eq!(second.attributes.parts.unwrap().list[0].object, "square");
    }
}

#[test]
fn parts_of_materials_that_are_left_out_are_noted() {
    let mut root = dressed();
    root["materials"][2]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 1.into();
    root["materials"][2]["normalTexture"]["index"] = 1.into();
    root["materials"][2]["emissiveTexture"] = json!({ "index": 2 });
    root["materials"][0]["extensions"] = json!({ "KHR_materials_clearcoat": {} });
    let read = gltf::parse(root.to_string().as_bytes(), &no_files).unwrap();
    assert_eq!(
        read.notes,
        [
            "image 1 is left out: it is neither PNG nor JPEG",
            "textures that use TEXCOORD_1 are left out",
            "textures without a PNG or JPEG image are left out",
            "the extension KHR_materials_clearcoat of materials is left out",
        ]
    );
    assert!(look(&read.attributes, 1).textures.is_empty());
    let mut root = dressed();
    root["images"][0] = json!({ "uri": "gone.png" });
    assert_eq!(load(&root).unwrap().1, ["image 0 is left out: no files here"]);
}

#[test]
fn numbers_in_materials_are_checked() {
    for (pointer, value, expected) in [
        (
            "/meshes/0/primitives/0/material",
            json!(3),
            (", mesh 0", "a primitive uses material 3, but there are only 3"),
        ),
        ("/materials/2/normalTexture/index", json!(9), (", material 2", "uses texture 9, but there are only 3")),
        ("/textures/0/source", json!(2), (", texture 0", "uses image 2, but there are only 2")),
        ("/textures/0/sampler", json!(-1), (", texture 0", "uses sampler -1, but there are only 1")),
        ("/images/0/bufferView", json!(4), (", buffer view 4", "does not exist")),
        ("/materials/2/alphaMode", json!("X"), (", material 2", "has the unknown alpha mode 'X'")),
        ("/materials/2/emissiveFactor", json!([1]), (", material 2", "has a factor that is not 3 numbers")),
        ("/materials/2", json!(5), (", material 2", "is not an object")),
        ("/images/0", json!({}), (", image 0", "has no data")),
    ] {
        let mut root = dressed();
        *root.pointer_mut(pointer).unwrap() = value;
        let result = load(&root);
        assert_eq!((place(result.clone()).as_str(), cause(result).as_str()), expected);
    }
}

#[test]
fn many_names_of_one_image_are_one_image() {
    let mut root = dressed();
    root["images"] = json!([{ "uri": address(PNG) }, { "uri": address(PNG) }]);
    let read = gltf::parse(root.to_string().as_bytes(), &no_files).unwrap();
    assert_eq!(read.attributes.materials.unwrap().images.len(), 1);
    let mut root = dressed();
    root["nodes"] = json!([{ "mesh": 0, "name": "a".repeat(1000) }]);
    root["scenes"] = json!([{ "nodes": [0] }]);
    let parts = gltf::parse(root.to_string().as_bytes(), &no_files).unwrap().attributes.parts.unwrap();
    assert_eq!(parts.list[0].object.len(), crate::mesh::parts::LONGEST_NAME);
}

#[test]
fn images_that_share_a_view_are_bounded() {
    let mut root = dressed();
    let image = [PNG, &vec![0; 1 << 20]].concat();
    root["buffers"][0] = json!({ "byteLength": 100 + image.len(), "uri": address(&[&[0; 100][..], &image].concat()) });
    root["bufferViews"][3] = json!({ "buffer": 0, "byteOffset": 100, "byteLength": image.len() });
    root["meshes"][0]["primitives"][0]["material"] = 0.into();
    root["meshes"][0]["primitives"] =
        (0..70).map(|m| json!({ "attributes": { "POSITION": 0 }, "material": m })).collect();
    root["images"] = (0..70).map(|_| json!({ "bufferView": 3 })).collect();
    root["textures"] = (0..70).map(|image| json!({ "source": image })).collect();
    root["materials"] = (0..70).map(|texture| json!({ "normalTexture": { "index": texture } })).collect();
    assert_eq!(place(load(&root)), ", image 63");
}
