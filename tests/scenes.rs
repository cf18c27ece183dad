//! Scene files, from the command line: what is built, what is refused and why, and what the cache keeps.

use std::fs;
use std::path::Path;
use std::process::Output;

use assert_cmd::Command;
use openwork::verify::{MeshReport, read_stl};
use proptest::prelude::*;
use tempfile::TempDir;

/// A hoop, and three posts around it that stand in it.
const SCENE: &str = r#"
shells = 1
output = ["crown.stl"]
[every]
chord = "0.1mm"
[part.hoop]
strip = "ring:30mm"
width = "4mm"
thickness = "3mm"
[part.post]
strip = true
points = [[16.5, 0, 1], [17, 1, 10], [16, 0, 20]]
width = "3mm"
thickness = "2mm"
repeat = 3
[[joint]]
between = ["post", "hoop"]
width = "0.5mm"
"#;

/// A folder with a scene and a cache of its own.
struct Workbench {
    folder: TempDir,
}

impl Workbench {
    fn new(scene: &str) -> Self {
        let bench = Self { folder: tempfile::tempdir().unwrap() };
        bench.write("scene.toml", scene);
        bench
    }

    fn path(&self) -> &Path {
        self.folder.path()
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.path().join(name), text).unwrap();
    }

    fn command(&self) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_openwork"));
        command.args(["build", "scene.toml", "--cache", "cache"]).current_dir(self.path());
        command
    }

    fn build(&self) -> Output {
        self.command().output().unwrap()
    }

    /// What is said when the scene is refused, and with which exit code.
    fn refusal(&self) -> (i32, String) {
        let output = self.build();
        assert!(!self.path().join("crown.stl").exists(), "a file was written");
        (output.status.code().unwrap(), text(&output))
    }

    fn found(&self) -> MeshReport {
        read_stl(&fs::read(self.path().join("crown.stl")).unwrap()).unwrap()
    }
}

fn text(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

#[test]
fn parts_are_joined_into_one_solid() {
    let bench = Workbench::new(SCENE);
    let mut command = bench.command();
    let output = command.args(["--report", "report.json"]).output().unwrap();
    assert!(output.status.success(), "{}", text(&output));
    let found = bench.found();
    assert_eq!((found.faults.len(), found.shells.len(), found.genus), (0, 1, 1));
    let report: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(bench.path().join("report.json")).unwrap()).unwrap();
    assert_eq!(report["joints"].as_array().unwrap().len(), 3);
    assert_eq!(report["parts"][1]["copies"][2]["name"], "post 3");
    let parts: f64 = 3.0 * report["parts"][1]["volume_mm3"].as_f64().unwrap()
        + report["parts"][0]["volume_mm3"].as_f64().unwrap();
    let shared: f64 =
        report["joints"].as_array().unwrap().iter().map(|j| j["shared_mm3"].as_f64().unwrap()).sum();
    assert!((found.volume_mm3 - (parts - shared)).abs() < 0.05, "{} {parts} {shared}", found.volume_mm3);
}

#[test]
fn an_ornament_is_judged_as_by_its_own_command() {
    let vine = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/exemplars/vine.svg");
    let scene = "output = [\"crown.stl\"]\n[part.vine]\nband = \"vine.svg\"\nalong = \"line:60mm\"\nwidth = \"12mm\"\n\
                 components = 1\nchord = \"0.1mm\"\nplace = { turn = [90, 0, 0], mirror = \"x\" }\n";
    let bench = Workbench::new(scene);
    bench.write("vine.svg", &fs::read_to_string(vine).unwrap());
    let output = bench.build();
    assert!(output.status.success(), "{}", text(&output));
    let found = bench.found();
    assert_eq!((found.faults.len(), found.shells.len()), (0, 1));
    let before = fs::read(bench.path().join("crown.stl")).unwrap();
    // Another exemplar is another part, whatever is in the cache.
    bench.write("vine.svg", &fs::read_to_string(vine.replace("vine", "wave")).unwrap());
    bench.write("scene.toml", &scene.replace("components = 1\n", ""));
    assert!(bench.build().status.success());
    assert_ne!(fs::read(bench.path().join("crown.stl")).unwrap(), before);
    // What cannot be had is refused as there, with the name of the part.
    bench.write("scene.toml", scene);
    bench.write("vine.svg", &fs::read_to_string(vine.replace("vine", "strands")).unwrap());
    fs::remove_file(bench.path().join("crown.stl")).unwrap();
    let (code, message) = bench.refusal();
    assert!(code == 3 && message.contains("part vine: "), "{code} {message}");
}

#[test]
fn parts_that_do_not_touch_are_named() {
    let bench = Workbench::new(&SCENE.replace("[[16.5, 0, 1], [17, 1, 10]", "[[16.5, 0, 6], [17, 1, 12]"));
    let (code, message) = bench.refusal();
    assert_eq!(code, 3, "{message}");
    for part in ["the joint of post 1 and hoop does not hold: they are", "mm apart, nearest at (", "overlap"]
    {
        assert!(message.contains(part), "{part}: {message}");
    }
    // What they share is too narrow.
    let bench = Workbench::new(&SCENE.replace("0.5mm", "5mm"));
    let (code, message) = bench.refusal();
    assert!(
        code == 3 && message.contains("mm wide at (") && message.contains("5 mm are wanted"),
        "{message}"
    );
}

#[test]
fn a_whole_that_is_not_as_declared_is_refused() {
    let apart = SCENE.replace("[[16.5, 0, 1], [17, 1, 10]", "[[16.5, 0, 6], [17, 1, 12]");
    let bench = Workbench::new(apart.split("[[joint]]").next().unwrap());
    let (code, message) = bench.refusal();
    assert_eq!(code, 4, "{message}");
    assert!(message.contains("the solid has 4 shell(s); 1 were asked for"), "{message}");
    assert!(message.contains("these hang together: hoop | post 1 | post 2 | post 3"), "{message}");
    let bench = Workbench::new(&SCENE.replace("shells = 1", "genus = 0"));
    let (code, message) = bench.refusal();
    assert!(code == 4 && message.contains("1 tunnel(s)"), "{code} {message}");
}

#[test]
fn wrong_scenes_are_told_with_their_lines() {
    let refused = |from: &str, to: &str| {
        assert!(SCENE.contains(from), "{from}");
        let (code, message) = Workbench::new(&SCENE.replace(from, to)).refusal();
        assert_eq!(code, 2, "{message}");
        message
    };
    for (from, to, parts) in [
        (
            "shells = 1",
            "shels = 1",
            &["scene.toml, line 2: the scene has no key shels; did you mean shells?"][..],
        ),
        ("width = \"4mm\"", "widht = 4", &["line 8: part hoop has no key widht; did you mean width?"]),
        ("width = \"4mm\"", "width = \"4furlong\"", &["line 8: width of part hoop is not right", "4furlong"]),
        ("chord = ", "chrod = ", &["line 5: every part has no key chrod; did you mean chord?"]),
        ("strip = \"ring:30mm\"", "strip = \"rnig:30mm\"", &["part hoop is not right", "rnig:30mm"]),
        (
            "strip = \"ring:30mm\"",
            "box = 3",
            &["line 6: part hoop is made from nothing", "band, rect, surface, extrude"],
        ),
        ("strip = true", "band = \"none.svg\"", &["part post", "none.svg"]),
        ("strip = true", "strip = \"line:9mm\"", &["strip of part post is a curve, and points are another"]),
        ("repeat = 3", "repeat = { times = 3 }", &["puts all copies in one place", "about = \"z\""]),
        (
            "repeat = 3",
            "place = { turn = 3 }",
            &["line 15: turn of place of part post is integer; use three numbers"],
        ),
        (
            "[\"post\", \"hoop\"]",
            "[\"post\", \"hop\"]",
            &["between of joint 1 names hop; the parts are hoop, post"],
        ),
        ("[\"post\", \"hoop\"]", "[\"post\"]", &["is not two parts"]),
        ("between = [\"post\", \"hoop\"]", "neighbours = \"hoop\"", &["is not repeated"]),
        ("crown.stl", "crown.svg", &["crown.svg is a flat drawing", ".stl, .3mf, .obj or .png"]),
        ("output = [\"crown.stl\"]", "", &["names a file"]),
        ("shells = 1", "shells = ", &["scene.toml", "line 2"]),
    ] {
        let message = refused(from, to);
        for part in parts {
            assert!(message.contains(part), "{part}: {message}");
        }
    }
    let bench = Workbench::new(SCENE);
    fs::remove_file(bench.path().join("scene.toml")).unwrap();
    let (code, message) = bench.refusal();
    assert!(code == 2 && message.contains("scene.toml: "), "{message}");
}

#[test]
fn what_did_not_change_is_kept() {
    let bench = Workbench::new(SCENE);
    assert!(bench.build().status.success());
    let first = fs::read(bench.path().join("crown.stl")).unwrap();
    let again = bench.build();
    assert!(text(&again).contains("unchanged"), "{}", text(&again));
    assert_eq!(fs::read(bench.path().join("crown.stl")).unwrap(), first);
    // Another joint is another whole of the same parts.
    bench.write("scene.toml", &SCENE.replace("0.5mm", "0.4mm"));
    let other = text(&bench.build());
    assert!(other.contains("from the cache") && !other.contains("unchanged"), "{other}");
    assert_eq!(fs::read(bench.path().join("crown.stl")).unwrap(), first);
    // Entries that were cut off are noticed, and made anew.
    for entry in fs::read_dir(bench.path().join("cache")).unwrap() {
        let entry = entry.unwrap().path();
        let bytes = fs::read(&entry).unwrap();
        fs::write(&entry, &bytes[..bytes.len() / 2]).unwrap();
    }
    let anew = bench.build();
    assert!(!text(&anew).contains("cache") && !text(&anew).contains("unchanged"), "{}", text(&anew));
    assert_eq!(fs::read(bench.path().join("crown.stl")).unwrap(), first);
    // Without a cache and on one thread the bytes are the same.
    let mut alone = Command::new(env!("CARGO_BIN_EXE_openwork"));
    alone.args(["build", "scene.toml", "--no-cache", "-q"]).env("OPENWORK_THREADS", "1");
    assert!(alone.current_dir(bench.path()).output().unwrap().status.success());
    assert_eq!(fs::read(bench.path().join("crown.stl")).unwrap(), first);
}

#[test]
fn two_processes_may_share_a_cache() {
    let bench = Workbench::new(SCENE);
    std::thread::scope(|scope| {
        let builds: Vec<_> = ["one.stl", "two.stl"]
            .map(|name| scope.spawn(|| bench.command().args(["-o", name]).output().unwrap()))
            .into_iter()
            .collect();
        for build in builds {
            let output = build.join().unwrap();
            assert!(output.status.success(), "{}", text(&output));
        }
    });
    let [one, two] = ["one.stl", "two.stl"].map(|name| fs::read(bench.path().join(name)).unwrap());
    assert_eq!(one, two);
    // Two parts and the whole, and nothing under a temporary name.
    assert_eq!(fs::read_dir(bench.path().join("cache")).unwrap().count(), 3);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]
    /// Two hoops with posts between them: one shell, and a tunnel more than there are posts.
    #[test]
    fn hoops_with_posts_have_the_genus_that_follows(
        posts in 1usize..7, lean in -9.0..9.0f64, thickness in 1.2..2.4f64, bulge in -0.4..0.4f64, width in 2.0..4.0f64,
    ) {
        let top = lean.to_radians();
        let point = |part: f64, radius: f64| {
            let (sin, cos) = (part * top).sin_cos();
            format!("[{}, {}, {}]", radius * cos, radius * sin, 1.0 + 18.0 * part)
        };
        let genus = posts + 1;
        let bench = Workbench::new(&format!(
            r#"
            shells = 1
            genus = {genus}
            output = ["crown.stl"]
            [every]
            chord = "0.1mm"
            [part.low]
            strip = "ring:30mm"
            width = "4mm"
            thickness = "3mm"
            [part.high]
            strip = "ring:30mm"
            width = "4mm"
            thickness = "3mm"
            place = {{ move = [0, 0, 16] }}
            [part.post]
            strip = true
            points = [{}, {}, {}]
            width = {width}
            thickness = {thickness}
            repeat = {posts}
            [[joint]]
            between = ["post", "low"]
            [[joint]]
            between = ["post", "high"]
            "#,
            point(0.0, 16.5),
            point(0.5, 16.5 + bulge),
            point(1.0, 16.5),
        ));
        let output = bench.build();
        prop_assert!(output.status.success(), "{}", text(&output));
        let found = bench.found();
        prop_assert!(found.faults.is_empty(), "{:?}", found.faults);
        prop_assert_eq!((found.shells.len(), found.genus), (1, genus as i64));
    }
}
