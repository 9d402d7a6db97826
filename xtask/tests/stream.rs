//! `cargo xtask stream` where it can't begin.

use std::net::TcpListener;
use std::process::Command;

#[test]
fn a_taken_port_is_said_before_anything_is_built() {
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let output = Command::new(env!("CARGO_BIN_EXE_xtask"))
        .args(["stream", "--port", &port])
        .env("PATH", "")
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(
        said.contains(&format!("port {port} can't be listened on; choose another with --port")),
        "{said}"
    );
}
