//! Levels of detail: one file each, all in one file, or as tiles.

use super::*;

#[test]
fn levels_are_files_or_one_file() {
    let folder = folder();
    let read = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    let told = run(folder.path(), "sphere.off out.ply --levels 400,100 --report r.json").went_well().to_owned();
    assert!(
        told.contains("-> out-1.ply\n") && told.contains("-> out-2.ply\n") && !folder.path().join("out.ply").exists()
    );
    run(folder.path(), "sphere.off alone.ply --points 100 -q").went_well();
    assert!(read("out-2.ply") == read("alone.ply"));
    let reports = json(&std::fs::read_to_string(folder.path().join("r.json")).unwrap());
    let members = |of: &serde_json::Value| {
        let stages: Vec<String> = of["stages"].as_array().unwrap().iter().map(|s| s["name"].to_string()).collect();
        (of["output"]["topology"]["vertices"].as_u64(), stages.join(" "))
    };
    let [fine, coarse] = [0, 1].map(|level| members(&reports[level]));
    assert_eq!((fine.0, coarse.0, reports[2].is_null()), (Some(400), Some(100), true));
    assert!(fine.1.starts_with("\"read\" \"repair\" \"sample\"") && fine.1.ends_with("\"measure\""), "{}", fine.1);
    assert!(coarse.1.starts_with("\"sample\"") && coarse.1.ends_with("\"write\""), "{}", coarse.1);

    // One file, from which other programs read the finest level; a page with all levels; and the worst of their exit statuses.
    let ran = run(folder.path(), "sphere.off out.glb --levels 400,100 --max-error 0.02 --report r.html -q");
    assert_eq!(ran.status, 3, "{}", ran.err);
    assert!(ran.err.starts_with("remesh: out.glb, level 2: written but not verified"), "{}", ran.err);
    let quality = json(run(folder.path(), "quality out.glb --json").went_well());
    assert_eq!(quality["output"]["topology"]["vertices"], 400);
    assert!(String::from_utf8(read("r.html")).unwrap().contains("out.glb, level 1"));

    let before = files(folder.path());
    run(folder.path(), "sphere.off out.obj --levels 100,400").failed(2, &["--levels: 400 comes after 100"]);
    run(folder.path(), "sphere.off absent/out.obj --levels 400,100").failed(1, &["absent"]);
    run(folder.path(), "sphere.off /dev/stdout --output-format obj --levels 400,100").failed(1, &["a single stream"]);
    assert_eq!(files(folder.path()), before);
}

#[test]
fn levels_are_tiles_that_name_their_files() {
    let folder = folder();
    let told = run(folder.path(), "sphere.off tiles.json --levels 400,100 --report r.json").went_well().to_owned();
    assert!(told.contains("-> tiles.json, level 1\n") && told.contains("-> tiles.json, level 2\n"), "{told}");
    let text = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    let (tileset, reports) = (json(&text("tiles.json")), json(&text("r.json")));
    let coarse = &tileset["root"]["children"][0];
    let fine = &coarse["children"][0];
    let quality = |tile: &serde_json::Value| {
        let file = tile["content"]["uri"].as_str().unwrap();
        json(run(folder.path(), &format!("quality {file} --json")).went_well())["output"]["topology"]["vertices"]
            .as_u64()
    };
    assert_eq!((quality(coarse), quality(fine)), (Some(100), Some(400)));
    // The error of the coarse level is the distance that its report gives in percent of the diagonal.
    let told = 0.01 * reports[1]["distance"]["hausdorff"].as_f64().unwrap() * 12f64.sqrt();
    let error = coarse["geometricError"].as_f64().unwrap();
    assert!((error / told - 1.0).abs() < 0.1 && fine["geometricError"] == 0.0, "{error} {told}");

    let before = files(folder.path());
    run(folder.path(), "sphere.off absent/tiles.json --levels 400,100").failed(1, &["absent"]);
    std::fs::create_dir(folder.path().join("other-2-0.glb")).unwrap();
    run(folder.path(), "sphere.off other.json --levels 400,100").failed(1, &["other-2-0.glb", "folder"]);
    std::fs::remove_dir(folder.path().join("other-2-0.glb")).unwrap();
    assert_eq!(files(folder.path()), before);
}
