//! Runs that do not come to their own end: interrupted, out of room, without a reader. Nothing is left behind, and nobody
//! is shouted at.

#![cfg(unix)]

#[allow(dead_code, reason = "each test crate uses a part of it")]
mod common;

use std::io::Read;
use std::os::unix::process::ExitStatusExt;
use std::process::{Child, Command, ExitStatus, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use common::Room;

const SIGHUP: i32 = 1;
const SIGINT: i32 = 2;
const SIGTERM: i32 = 15;

/// Several bands, each with files that wait for the last one under temporary names.
const LONG: &str =
    "band vine.svg --along circle:65mm --width 14mm --components 1 --count 6 -o out.svg -o out.stl";

/// A command of the system in the room, with the program as `$OPENWORK`.
fn system(room: &Room, program: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new(program);
    command
        .current_dir(room.path(""))
        .args(arguments)
        .env("OPENWORK", assert_cmd::cargo::cargo_bin("openwork"));
    command
}

fn shell(room: &Room, script: &str) -> Output {
    system(room, "sh", &["-c", script]).output().unwrap()
}

/// The program in the room, running.
fn started(room: &Room, arguments: &str) -> Child {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin("openwork"));
    command.current_dir(room.path("")).args(arguments.split_whitespace());
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Waits until `is_so`, which must come to pass while the program runs.
fn wait_until(child: &mut Child, mut is_so: impl FnMut() -> bool) {
    let begin = Instant::now();
    while !is_so() {
        assert!(child.try_wait().unwrap().is_none(), "the program ended too soon");
        assert!(begin.elapsed() < Duration::from_secs(120), "this takes too long");
        sleep(Duration::from_millis(5));
    }
}

fn has_temporary_file(room: &Room) -> bool {
    let names = std::fs::read_dir(room.path("")).unwrap().map(|entry| entry.unwrap().file_name());
    names.into_iter().any(|name| name.to_string_lossy().starts_with(".openwork-"))
}

/// Sends a signal, and waits for the end. The child is still ours, so that its number is no one else's.
fn end_by(child: &mut Child, signal: i32) -> ExitStatus {
    send(child, signal);
    child.wait().unwrap()
}

fn send(child: &Child, signal: i32) {
    let sent = Command::new("kill").args([format!("-{signal}"), child.id().to_string()]).status().unwrap();
    assert!(sent.success());
}

/// Whether this test was started with a signal switched off, which the program respects.
fn is_switched_off(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.map_or(0, |mask| u64::from_str_radix(mask.trim(), 16).unwrap());
    let is_off = mask >> (signal - 1) & 1 == 1;
    if is_off {
        eprintln!("skipped: signal {signal} is switched off for this process");
    }
    is_off
}

#[test]
fn a_signal_leaves_no_file_behind() {
    for signal in [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|&signal| !is_switched_off(signal)) {
        let room = Room::with(&["vine.svg"]);
        room.write("out-01.svg", "the old one");
        let before = room.contents();
        let mut run = started(&room, LONG);
        wait_until(&mut run, || has_temporary_file(&room));
        let status = end_by(&mut run, signal);
        // What a shell shows as 128 and the number.
        assert_eq!((status.code(), status.signal()), (None, Some(signal)));
        assert!(before == room.contents(), "{:?}", room.contents().keys());
        let mut said = String::new();
        run.stderr.take().unwrap().read_to_string(&mut said).unwrap();
        assert_eq!(said, "");
    }
}

#[test]
fn a_shell_sees_130_and_143() {
    for (signal, code) in [(SIGINT, 130), (SIGTERM, 143)].into_iter().filter(|&(s, _)| !is_switched_off(s)) {
        let room = Room::with(&["vine.svg"]);
        // The shell tells the number of the program, waits for it, and tells the code.
        let script = format!("\"$OPENWORK\" {LONG} 2>/dev/null; echo $?");
        let mut shell = system(&room, "sh", &["-c", &script]).stdout(Stdio::piped()).spawn().unwrap();
        wait_until(&mut shell, || has_temporary_file(&room));
        let children = Command::new("ps").args(["-o", "pid=", "--ppid", &shell.id().to_string()]).output();
        let Some(program) = children.ok().and_then(|found| String::from_utf8(found.stdout).ok()) else {
            eprintln!("skipped: there is no ps to find the program with");
            shell.wait().unwrap();
            return;
        };
        let sent = Command::new("kill").args([&format!("-{signal}"), program.trim()]).status().unwrap();
        assert!(sent.success(), "{program}");
        let mut said = String::new();
        shell.stdout.take().unwrap().read_to_string(&mut said).unwrap();
        shell.wait().unwrap();
        assert_eq!(said.trim(), code.to_string());
        assert!(!has_temporary_file(&room) && !room.path("out-01.svg").exists());
    }
}

#[cfg(target_os = "linux")]
#[test]
fn what_was_switched_off_stays_off() {
    let room = Room::with(&["vine.svg"]);
    let script = format!("trap '' HUP; exec \"$OPENWORK\" {LONG} --quiet");
    let mut run = system(&room, "sh", &["-c", &script]).spawn().unwrap();
    wait_until(&mut run, || has_temporary_file(&room));
    assert_eq!(end_by(&mut run, SIGHUP).code(), Some(0));
    assert!(room.path("out-01.svg").exists() && room.path("out-06.stl").exists());
}

/// What was written where there is no room: the code, the message, and the names that are there afterwards.
fn told(output: &Output) -> (Option<i32>, String, String) {
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    (output.status.code(), text(&output.stderr), text(&output.stdout))
}

#[test]
fn a_full_disk_is_told_and_keeps_nothing() {
    let room = Room::with(&["vine.svg"]);
    std::fs::create_dir(room.path("small")).unwrap();
    // A file system of a few kilobytes that only this shell and its children see.
    let mount = "mount -t tmpfs -o size=64k none small";
    if !system(&room, "unshare", &["-rm", "sh", "-c", mount]).output().is_ok_and(|o| o.status.success()) {
        eprintln!("skipped: this system lets nobody mount a small file system");
        return;
    }
    // The drawing has room, the solid has none: neither is left.
    let band = "\"$OPENWORK\" band ../vine.svg --along line:120mm -o out.svg -o out.stl --report out.json";
    let script = format!("{mount} && cd small && {{ {band}; code=$?; ls -A; exit $code; }}");
    let (code, said, left) = told(&system(&room, "unshare", &["-rm", "sh", "-c", &script]).output().unwrap());
    assert_eq!((code, left.as_str()), (Some(2), ""), "{said}");
    for words in ["error: cannot write out.stl: ", "No space left on device", "free some space"] {
        assert!(said.contains(words), "{said}");
    }
    assert!(!said.contains(".openwork"), "{said}");
}

#[test]
fn a_file_that_may_not_grow_is_told_and_keeps_nothing() {
    let room = Room::with(&["vine.svg"]);
    std::fs::create_dir(room.path("out")).unwrap();
    let band = "\"$OPENWORK\" band vine.svg --along line:120mm -o out/a.svg -o out/a.stl";
    let (code, said, left) =
        told(&shell(&room, &format!("ulimit -f 400; {band}; code=$?; ls -A out; exit $code")));
    assert_eq!((code, left.as_str()), (Some(2), ""), "{said}");
    assert!(said.contains("cannot write out/a.stl: File too large") && said.contains("ulimit -f"), "{said}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_output_is_told() {
    let room = Room::with(&["vine.svg"]);
    let before = room.contents();
    // A file beside it is not left alone.
    for job in ["band vine.svg --along line:120mm -o - -o out.png", "schema", "analyze vine.svg", "man"] {
        let (code, said, _) = told(&shell(&room, &format!("\"$OPENWORK\" {job} >/dev/full")));
        assert_eq!(code, Some(2), "{job}: {said}");
        assert!(said.contains("standard output: No space left on device"), "{job}: {said}");
        assert!(before == room.contents(), "{job}");
    }
}

#[test]
fn a_reader_who_has_had_enough_is_no_failure() {
    let room = Room::with(&["vine.svg"]);
    for job in [
        "schema",
        "--help",
        "band --help",
        "man",
        "completions bash",
        "analyze vine.svg --json",
        "extrude vine.svg -o -",
        "verify vine.svg",
    ] {
        let mut run = started(&room, job);
        drop(run.stdout.take());
        let mut said = String::new();
        run.stderr.take().unwrap().read_to_string(&mut said).unwrap();
        assert_eq!(run.wait().unwrap().code(), Some(0), "{job}: {said}");
        assert!(!said.contains("panic") && !said.contains("error"), "{job}: {said}");
    }
    // Nobody reads the messages either.
    let mut run = started(&room, "band vine.svg --along line:120mm -o out.svg");
    drop((run.stdout.take(), run.stderr.take()));
    assert_eq!(run.wait().unwrap().code(), Some(0));
    assert!(room.path("out.svg").exists());
}

/// Whether there is an escape code that sets a colour or a face.
fn is_coloured(bytes: &[u8]) -> bool {
    let codes = bytes.windows(2).enumerate().filter(|(_, pair)| *pair == b"\x1b[");
    codes.into_iter().any(|(at, _)| {
        bytes[at + 2..].iter().find(|b| !b.is_ascii_digit() && **b != b';').is_some_and(|end| *end == b'm')
    })
}

#[test]
fn colours_are_for_terminals_and_for_whoever_wants_them() {
    let room = Room::with(&["vine.svg"]);
    let jobs = ["--help", "band --width", "band vine.svg --along line:120mm -o out.svg"];
    let run = |job: &str, variables: &[(&str, &str)]| {
        let mut command = room.command(job);
        command.env_remove("NO_COLOR").env_remove("CLICOLOR_FORCE").envs(variables.iter().copied());
        let output = command.output().unwrap();
        [output.stdout, output.stderr].concat()
    };
    for job in jobs {
        assert!(!run(job, &[]).contains(&0x1b), "{job}");
        assert!(!run(job, &[("NO_COLOR", "1")]).contains(&0x1b), "{job}");
    }
    assert!(is_coloured(&run("--help", &[("CLICOLOR_FORCE", "1")])));
    // A terminal that is none, from util-linux.
    let on_terminal = |variables: &str, job: &str| {
        let inner = format!("env -u NO_COLOR -u CLICOLOR_FORCE TERM=xterm {variables} \"$OPENWORK\" {job}");
        system(&room, "script", &["-qec", &inner, "/dev/null"]).stdin(Stdio::null()).output()
    };
    match on_terminal("", "--help") {
        Ok(seen) if seen.status.success() => assert!(is_coloured(&seen.stdout)),
        _ => return eprintln!("skipped: there is no script(1) to make a terminal with"),
    }
    for job in jobs {
        let seen = on_terminal("NO_COLOR=1", job).unwrap().stdout;
        assert!(!seen.is_empty() && !is_coloured(&seen), "{job}: {}", String::from_utf8_lossy(&seen));
    }
}
