//! Small luminaires of both formats, and files that are none.

use super::*;
use crate::scene::description::Goniometer;
use glam::DVec3;
use std::f64::consts::PI;

fn ies(planes: &str, rows: &str, values: &str) -> String {
    let count = |list: &str| list.split_whitespace().count();
    format!(
        "IESNA:LM-63-2002\r\n[TEST] 1\r\n[MANUFAC] a\r\nTILT=NONE\r\n1 1000 2 {} {} 1 2 0.1 0.1 0\r\n1 0.5 20\r\n{rows}\r\n{planes}\r\n{values}\r\n",
        count(rows),
        count(planes),
    )
}

fn direction(c: f64, gamma: f64) -> DVec3 {
    let ((sin_c, cos_c), (sin, cos)) = (c.to_radians().sin_cos(), gamma.to_radians().sin_cos());
    DVec3::new(sin * cos_c, sin * sin_c, -cos)
}

#[track_caller]
fn close(value: f32, expected: f64) {
    assert!((f64::from(value) - expected).abs() < 1e-4, "{value} is not {expected}");
}

#[test]
fn straight_lines_join_the_measured_angles() {
    let text = ies("0", "0 45 90", "100 50 0");
    let web = read(text.as_bytes(), "a.ies").unwrap();
    assert_eq!(web.lamp_flux, Some(1000.0));
    for c in [0.0, 77.0, 200.0] {
        close(web.intensity(direction(c, 0.0)), 100.0);
        close(web.intensity(direction(c, 30.0)), 200.0 / 3.0);
        close(web.intensity(direction(c, 90.0)), 0.0);
        close(web.intensity(direction(c, 120.0)), 0.0);
    }
}

/// I = I₀ cos γ gives π I₀ lumens, a uniform sphere 4π I₀.
#[test]
fn the_flux_is_the_integral() {
    let rows: Vec<String> = (0..=90).map(|degrees| degrees.to_string()).collect();
    let cosines = (0..=90).map(|degrees| f64::from(degrees).to_radians().cos() * 300.0);
    let cosines: Vec<String> = cosines.map(|value| format!("{value:.6}")).collect();
    let web = read(ies("0", &rows.join(" "), &cosines.join(" ")).as_bytes(), "a.ies").unwrap();
    assert!((web.flux() / (300.0 * PI) - 1.0).abs() < 1e-3, "{}", web.flux());
    let web = read(ies("0", "0 180", "10 10").as_bytes(), "a.ies").unwrap();
    assert!((web.flux() / (40.0 * PI) - 1.0).abs() < 1e-6, "{}", web.flux());
}

#[test]
fn quarters_and_halves_are_continued_to_the_whole() {
    // In the plane of the horizon; the values tell the planes apart.
    let at = |planes: &str, values: &str, c: f64| {
        let text = ies(planes, "0 90", values);
        read(text.as_bytes(), "a.ies").unwrap().intensity(direction(c, 90.0))
    };
    let quarter = ("0 45 90", "0 1  0 2  0 3");
    for (c, expected) in [
        (0.0, 1.0),
        (45.0, 2.0),
        (90.0, 3.0),
        (135.0, 2.0),
        (180.0, 1.0),
        (225.0, 2.0),
        (270.0, 3.0),
        (300.0, 7.0 / 3.0),
        (359.0, 1.0 + 1.0 / 45.0),
    ] {
        close(at(quarter.0, quarter.1, c), expected);
    }
    let half = ("0 90 180", "0 1  0 2  0 3");
    for (c, expected) in [(0.0, 1.0), (45.0, 1.5), (180.0, 3.0), (270.0, 2.0), (315.0, 1.5)] {
        close(at(half.0, half.1, c), expected);
    }
    let other_half = ("90 180 270", "0 1  0 2  0 3");
    for (c, expected) in
        [(90.0, 1.0), (180.0, 2.0), (270.0, 3.0), (0.0, 2.0), (45.0, 1.5), (315.0, 2.5)]
    {
        close(at(other_half.0, other_half.1, c), expected);
    }
    let whole = ("0 90 180 270 360", "0 1  0 2  0 3  0 4  0 1");
    for (c, expected) in [(0.0, 1.0), (225.0, 3.5), (315.0, 2.5), (350.0, 1.0 + 3.0 / 9.0)] {
        close(at(whole.0, whole.1, c), expected);
    }
    let open = ("0 90 180 270", "0 1  0 2  0 3  0 4");
    close(at(open.0, open.1, 315.0), 2.5);
}

#[test]
fn floodlights_and_headlamps_have_angles_of_their_own() {
    let text = |kind: u32| {
        ies("-90 0 90", "0 90", "0 0  4 2  8 0").replace(" 1 2 0.1", &format!(" {kind} 2 0.1"))
    };
    let b = read(text(2).as_bytes(), "b.ies").unwrap();
    assert_eq!(b.goniometer, Goniometer::B);
    close(b.intensity(-DVec3::Z), 4.0);
    close(b.intensity(DVec3::X), 8.0);
    close(b.intensity(DVec3::Y), 2.0);
    close(b.intensity(-DVec3::Y), 2.0);
    close(b.intensity(DVec3::new(0.5, 0.0, -0.75_f64.sqrt())), 4.0 + 4.0 / 3.0);
    let a = read(text(3).as_bytes(), "a.ies").unwrap();
    close(a.intensity(DVec3::X), 8.0);
    close(a.intensity(DVec3::Z), 0.0);
}

#[test]
fn tilt_is_skipped_and_old_headers_are_read() {
    let included =
        ies("0", "0 90", "1 2").replace("TILT=NONE", "a lamp\nTILT=INCLUDE\n1\n2\n0 90\n1 0.9");
    assert_eq!(read(included.as_bytes(), "a.ies").unwrap().vertical.len(), 2);
    let commas = "TILT=NONE\n1,-1,1,2,1,1,2,0,0,0\n1,1,20\n0,90\n0\n5,\n6\n";
    let web = read(commas.as_bytes(), "a.ies").unwrap();
    assert_eq!((web.intensities, web.lamp_flux), (vec![5.0, 6.0], None));
}

/// One lamp of 2000 lm; `symmetry`, the C angles and the intensities in cd/klm over γ = 0°, 90°.
fn ldt(symmetry: u32, angles: &[f64], planes: &[f64]) -> String {
    let mut lines: Vec<String> = vec!["maker".into(), "1".into(), symmetry.to_string()];
    lines.extend([angles.len().to_string(), "0".into(), "2".into(), "90".into()]);
    lines.extend((8..=23).map(|line| format!("line {line}")));
    lines.extend(["1,0", "0", "1", "2", "LED", "2000", "830", "80", "25"].map(String::from));
    lines.extend((0..10).map(|_| "0.5".into()));
    lines.extend(angles.iter().map(f64::to_string));
    lines.extend(["0".into(), "90".into()]);
    lines.extend(planes.iter().flat_map(|plane| ["0".into(), plane.to_string()]));
    lines.join("\r\n")
}

#[test]
fn eulumdat_is_read_with_every_symmetry() {
    let angles = [0.0, 45.0, 90.0, 135.0, 180.0, 225.0, 270.0, 315.0];
    for (symmetry, planes, expected) in [
        (0, vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0], [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]),
        (1, vec![3.0], [3.0; 8]),
        (2, vec![1.0, 2.0, 3.0, 4.0, 5.0], [1.0, 2.0, 3.0, 4.0, 5.0, 4.0, 3.0, 2.0]),
        // From C270 over C0 to C90.
        (3, vec![1.0, 2.0, 3.0, 4.0, 5.0], [3.0, 4.0, 5.0, 4.0, 3.0, 2.0, 1.0, 2.0]),
        (4, vec![1.0, 2.0, 3.0], [1.0, 2.0, 3.0, 2.0, 1.0, 2.0, 3.0, 2.0]),
    ] {
        let web = read(ldt(symmetry, &angles, &planes).as_bytes(), "a.LDT").unwrap();
        assert_eq!(web.lamp_flux, Some(2000.0));
        for (c, expected) in angles.into_iter().zip(expected) {
            // Of two thousand lumens.
            close(web.intensity(direction(c, 90.0)), 2.0 * expected);
        }
        assert!(web.intensity(direction(20.0, 45.0)) > 0.0);
    }
}

#[test]
fn what_is_no_luminaire_is_refused_with_its_line() {
    let good = ies("0 90", "0 45 90", "1 2 3 4 5 6");
    let complaint = |text: &str| read(text.as_bytes(), "a.ies").expect_err(text).to_string();
    for (from, to, expected) in [
        ("TILT=NONE", "TILT=", "a.ies:4: refers to another file"),
        ("TILT=NONE", "", "no line with TILT="),
        ("0 45 90", "0 90 45", "a.ies:7: needs ascending vertical angles"),
        ("0 45 90", "0 45 190", "a.ies:7: needs vertical angles from 0 to 180 degrees, not 190"),
        ("4 5 6", "4 5", "the file ends where an intensity should be"),
        ("4 5 6", "4 x 6", "a.ies:9: needs a number: an intensity"),
        ("4 5 6", "4 -5 6", "light is never less than none"),
        ("4 5 6", "4 nan 6", "a.ies:9: needs a number"),
        ("1 1000 2 3 2", "1 1000 2 3 4000000", "more than 4194304 directions"),
        ("1 1000 2 3 2", "1 1000 2 3 9e99", "a.ies:5: needs a number of horizontal angles from 1"),
        ("1 1000 2 3 2", "1 1000 2 3 0.5", "a.ies:5: needs a number of horizontal angles from 1"),
        ("1 2 0.1", "4 2 0.1", "a.ies:5: needs photometric type 1, 2 or 3, not 4"),
    ] {
        let complaint = complaint(&good.replacen(from, to, 1));
        assert!(complaint.contains(expected), "{complaint}");
    }
    let angles = [0.0, 90.0, 180.0, 270.0];
    let good = ldt(2, &angles, &[1.0, 2.0, 3.0]);
    assert!(read(good.as_bytes(), "a.ldt").is_ok());
    for (from, to) in [
        ("\r\n2\r\n4", "\r\n5\r\n4"),
        ("\r\n180", "\r\n170"),
        ("2000", "0"),
        ("1,0", "x"),
        ("\r\n90\r\n0\r\n1", "\r\n90\r\n0\r\n-1"),
        ("270\r\n", "260\r\n80\r\n"),
    ] {
        let bad = good.replacen(from, to, 1);
        assert_ne!(bad, good, "{from:?}");
        assert!(read(bad.as_bytes(), "a.ldt").is_err(), "{from:?} → {to:?}");
    }
    for end in 0..good.len() {
        let _ = read(&good.as_bytes()[..end], "a.ldt");
    }
    for hostile in ["", "\0", "TILT=NONE", "TILT=NONE\n1 1 1 4194304 1 1 1 0 0 0 1 1 1"] {
        assert!(read(hostile.as_bytes(), "a.ies").is_err());
        assert!(read(hostile.as_bytes(), "a.ldt").is_err());
    }
}
