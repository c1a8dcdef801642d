//! `lie key`: bundles as users make them, and what is said of those that are odd.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;

use support::{bundles::Authority, secured::new_bundle};

#[test]
fn what_is_wrong_with_a_bundle_is_said() {
    let home = tempfile::tempdir().unwrap();
    let good = new_bundle(home.path(), "good.pem");
    let text = std::fs::read_to_string(&good).unwrap();
    let scene = support::cornell();
    let view = |bundle: &str| {
        let mut view = support::lie();
        view.args(["view", "--constructor", "127.0.0.1:1", "--bundle", bundle]);
        support::failure(&mut view, 2)
    };
    let expired = Authority::new().node(-20, -10);
    let future = Authority::new().node(1000, 2000);
    let broken = home.path().join("broken.pem");
    for (content, parts) in [
        (String::new(), &["no certificate"][..]),
        ("hello".to_owned(), &["no certificate", "lie key new"]),
        (
            text.replacen("-----END", "-----FIN", 1),
            &[".pem:4", "no end"],
        ),
        (expired, &["has expired"]),
        (future, &["not valid before"]),
    ] {
        std::fs::write(&broken, content).unwrap();
        let message = view(broken.to_str().unwrap());
        for part in parts.iter().chain([&"broken.pem"]) {
            assert!(message.contains(part), "{part}: {message}");
        }
    }
    assert!(view("no/such.pem").contains("no/such.pem"));
    let mut both = support::lie();
    both.arg("run")
        .arg(&scene)
        .args(["--bundle", &good, "--insecure"]);
    assert!(support::failure(&mut both, 2).contains("exclude each other"));
}

#[test]
fn bundles_are_private_shown_without_their_key_and_not_overwritten() {
    use std::os::unix::fs::PermissionsExt;
    let home = tempfile::tempdir().unwrap();
    let path = new_bundle(home.path(), "cluster.pem");
    let mode = std::fs::metadata(&path).unwrap().permissions().mode();
    assert_eq!(mode & 0o777, 0o600);
    let before = std::fs::read(&path).unwrap();
    let again = support::failure(support::lie().args(["key", "new", "--out", &path]), 2);
    assert!(
        again.contains("--force") && again.contains("cluster.pem"),
        "{again}"
    );
    assert_eq!(before, std::fs::read(&path).unwrap());

    let shown = |arguments: &[&str]| {
        let output = support::lie().args(arguments).output().unwrap();
        assert!(output.status.success());
        String::from_utf8(output.stdout).unwrap()
    };
    let show = shown(&["key", "show", &path]);
    assert!(
        show.contains("cluster: SHA256:") && show.contains("valid: "),
        "{show}"
    );
    assert!(!show.contains("PRIVATE"), "{show}");
    let forced = shown(&["key", "new", "--out", &path, "--force", "--days", "2"]);
    assert_ne!(before, std::fs::read(&path).unwrap());
    assert!(!forced.contains("PRIVATE"), "{forced}");
    for days in ["0", "3651", "-1", "x"] {
        let mut new = support::lie();
        new.args(["key", "new", "--days", days, "--out"])
            .arg(home.path().join("other"));
        support::failure(&mut new, 2);
    }
}
