//! Where the sun stands: by direction, by angles, or by place and time.

use super::document::{At, Document, Span};
use crate::diagnostic::Result;
use crate::suggest::quoted;
use crate::units::written::{Angle, Direction, schema};
use glam::{DQuat, DVec3};
use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, Visitor};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt;
use toml::value::{Datetime, Offset};

/// The sun's place in the sky: exactly one of `direction`, `elevation` (with `azimuth`), and `latitude`, `longitude` and
/// `time`.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub(super) struct SunPlaceKeys {
    /// The direction in which its light travels.
    direction: Option<At<Direction>>,
    /// Angle above the horizon. Default 45.
    elevation: Option<At<Angle>>,
    /// Angle from north to the east. Default 180, south.
    azimuth: Option<At<Angle>>,
    /// Of the place, north positive.
    latitude: Option<At<Angle>>,
    /// Of the place, east positive.
    longitude: Option<At<Angle>>,
    /// Date, time and zone: 2025-06-21T12:00:00+02:00.
    time: Option<At<Time>>,
    /// Angle across it, more than 0 and at most 180 degrees. Default 0.533.
    pub(super) angular_size: Option<At<Angle>>,
}

impl SunPlaceKeys {
    /// Unit vector to the sun in the sky's own space (x east, y north, z up); `to_world` turns that.
    pub(super) fn toward(
        &self,
        keys: &Span,
        document: &Document<'_>,
        to_world: DQuat,
    ) -> Result<DVec3> {
        let Self { direction, elevation, azimuth, latitude, longitude, time, .. } = self;
        let angles = elevation.as_ref().or(azimuth.as_ref()).map(|at| &at.span);
        let place = latitude.as_ref().or(longitude.as_ref()).map(|at| &at.span);
        let place = place.or(time.as_ref().map(|at| &at.span));
        match (direction, angles, place) {
            (Some(direction), None, None) => Ok(to_world.inverse() * -direction.value.0),
            (None, _, None) => self.by_angles(document),
            (None, None, Some(_)) => self.by_time(keys, document),
            (_, Some(span), _) | (_, _, Some(span)) => {
                let choice = "direction, elevation and azimuth, or latitude, longitude and time";
                Err(document.error(span, format!("is one too many: give {choice}")))
            }
        }
    }

    fn by_angles(&self, document: &Document<'_>) -> Result<DVec3> {
        let elevation = within(&self.elevation, 0.0, FRAC_PI_2, document)?;
        let azimuth = self.azimuth.as_ref().map_or(PI, |at| at.value.0);
        Ok(toward(elevation.unwrap_or(0.5 * FRAC_PI_2), azimuth))
    }

    fn by_time(&self, keys: &Span, document: &Document<'_>) -> Result<DVec3> {
        let latitude = within(&self.latitude, -FRAC_PI_2, FRAC_PI_2, document)?;
        let longitude = within(&self.longitude, -PI, PI, document)?;
        match (latitude, longitude, &self.time) {
            (Some(latitude), Some(longitude), Some(time)) => {
                Ok(position(time.value.0, latitude, longitude))
            }
            _ => Err(document.error(keys, "needs latitude, longitude and time, all three")),
        }
    }
}

/// The angle, if it is given and lies between two others.
fn within(
    angle: &Option<At<Angle>>,
    from: f64,
    to: f64,
    document: &Document<'_>,
) -> Result<Option<f64>> {
    let Some(At { span, value: Angle(angle) }) = angle else { return Ok(None) };
    // A hair of slack for angles written in radians.
    if (from - 1e-6..=to + 1e-6).contains(angle) {
        return Ok(Some(angle.clamp(from, to)));
    }
    let [from, to] = [from, to].map(f64::to_degrees);
    Err(document.error(span, format!("must be from {from}° to {to}°")))
}

/// A moment, in days since noon of 1 January 2000, universal time.
#[derive(Debug, Clone, Copy)]
struct Time(f64);

impl Time {
    /// `None` without date, time and zone.
    fn of(datetime: &Datetime) -> Option<Self> {
        let (date, time) = (datetime.date?, datetime.time?);
        let minutes = match datetime.offset? {
            Offset::Z => 0,
            Offset::Custom { minutes } => minutes,
        };
        let seconds =
            f64::from(time.second.unwrap_or(0)) + 1e-9 * f64::from(time.nanosecond.unwrap_or(0));
        let hours = f64::from(time.hour) + f64::from(time.minute) / 60.0 + seconds / 3600.0;
        let day = days(date.year.into(), date.month.into(), date.day.into());
        Some(Self(day + (hours - f64::from(minutes) / 60.0) / 24.0 - 0.5))
    }
}

/// Days from 1 January 2000 to a date of the Gregorian calendar.
fn days(year: i64, month: i64, day: i64) -> f64 {
    // Years begin in March, so that a leap day is their last.
    let years = year - i64::from(month < 3);
    let days_before_month = (153 * ((month + 9) % 12) + 2) / 5;
    let leap_days = years.div_euclid(4) - years.div_euclid(100) + years.div_euclid(400);
    (365 * years + leap_days + days_before_month + day - 730_426) as f64
}

/// Unit vector to the sun (x east, y north, z up) at a `time` (days since noon of 1 January 2000, universal time) and a
/// place (rad, north and east positive), as the air bends its light.
///
/// Michalsky, *The Astronomical Almanac's Algorithm for Approximate Solar Position*, Solar Energy 40(3), 1988: within
/// 0.01° from 1950 to 2050. Refraction: Sæmundsson 1986.
fn position(time: f64, latitude: f64, longitude: f64) -> DVec3 {
    let degrees = |angle: f64| angle.rem_euclid(360.0).to_radians();
    let anomaly = degrees(357.528 + 0.985_600_3 * time);
    let equation = 1.915 * anomaly.sin() + 0.020 * (2.0 * anomaly).sin();
    let ecliptic = degrees(280.460 + 0.985_647_4 * time + equation);
    let obliquity = (23.439 - 4e-7 * time).to_radians();
    let ascension = (obliquity.cos() * ecliptic.sin()).atan2(ecliptic.cos());
    let declination = (obliquity.sin() * ecliptic.sin()).asin();
    let sidereal = degrees(280.460_618 + 360.985_647_37 * time) + longitude;
    let (sin_hour, cos_hour) = (sidereal - ascension).sin_cos();
    let ((sin_lat, cos_lat), (sin_dec, cos_dec)) = (latitude.sin_cos(), declination.sin_cos());
    let east = -cos_dec * sin_hour;
    let north = sin_dec * cos_lat - cos_dec * sin_lat * cos_hour;
    let elevation = (sin_dec * sin_lat + cos_dec * cos_lat * cos_hour).asin();
    toward(elevation + refraction(elevation), east.atan2(north).rem_euclid(TAU))
}

/// How much higher the sun seems to stand than it does, rad.
fn refraction(elevation: f64) -> f64 {
    let h = elevation.to_degrees();
    if h < -1.0 {
        return 0.0;
    }
    let minutes = 1.02 / (h + 10.3 / (h + 5.11)).to_radians().tan();
    (minutes.max(0.0) / 60.0).to_radians()
}

/// Unit vector (x east, y north, z up) at angles above the horizon and from north to the east.
fn toward(elevation: f64, azimuth: f64) -> DVec3 {
    let ((up, across), (east, north)) = (elevation.sin_cos(), azimuth.sin_cos());
    DVec3::new(across * east, across * north, up)
}

const EXPECTED: &str = "a date, time and zone such as 2025-06-21T12:00:00+02:00";

struct TimeVisitor;

impl<'de> Visitor<'de> for TimeVisitor {
    type Value = Time;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(EXPECTED)
    }

    fn visit_str<E: Error>(self, text: &str) -> std::result::Result<Time, E> {
        let time = text.parse().ok().and_then(|datetime| Time::of(&datetime));
        time.ok_or_else(|| E::custom(format!("needs {EXPECTED}, not {}", quoted(text))))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> std::result::Result<Time, A::Error> {
        let datetime = Datetime::deserialize(MapAccessDeserializer::new(map))?;
        let message = || format!("needs {EXPECTED}, not {datetime}");
        Time::of(&datetime).ok_or_else(|| A::Error::custom(message()))
    }
}

impl<'de> Deserialize<'de> for Time {
    fn deserialize<D: Deserializer<'de>>(source: D) -> std::result::Result<Self, D::Error> {
        source.deserialize_any(TimeVisitor)
    }
}

schema!(Time: {
    "description": "Date, time and zone, with or without quotation marks",
    "examples": ["2025-06-21T12:00:00+02:00", "2025-12-21T09:30Z"]
});

#[cfg(test)]
mod tests {
    use super::*;

    fn angles(time: &str, latitude: f64, longitude: f64) -> [f64; 2] {
        let time = Time::of(&time.parse().unwrap()).unwrap();
        let sun = position(time.0, latitude.to_radians(), longitude.to_radians());
        [sun.z.asin().to_degrees(), sun.x.atan2(sun.y).rem_euclid(TAU).to_degrees()]
    }

    /// The worked example of Reda & Andreas, *Solar Position Algorithm for Solar Radiation Applications*, 2004.
    #[test]
    fn the_sun_stands_where_the_almanac_says() {
        let [elevation, azimuth] = angles("2003-10-17T12:30:30-07:00", 39.742476, -105.1786);
        assert!((elevation - (90.0 - 50.11162)).abs() < 0.02, "{elevation}");
        assert!((azimuth - 194.34024).abs() < 0.02, "{azimuth}");
    }

    /// At the solstice the sun stands above the tropic; the day is as long as the night at an equinox.
    #[test]
    fn seasons_and_zones_are_right() {
        let [noon, _] = angles("2024-06-20T12:02:00Z", 23.44, 0.0);
        assert!(noon > 89.8, "{noon}");
        let [winter, azimuth] = angles("2024-12-21T12:00:00+01:00", 52.52, 13.405);
        assert!((winter - (90.0 - 52.52 - 23.44)).abs() < 0.2 && (azimuth - 180.0).abs() < 5.0);
        let [rising, azimuth] = angles("2024-03-20T06:07:30Z", 0.0, 0.0);
        assert!((rising - 0.5).abs() < 0.3 && (azimuth - 90.0).abs() < 0.5, "{rising} {azimuth}");
        assert_eq!(angles("2024-06-20T14:02:00+02:00", 23.44, 0.0)[0], noon);
        let [night, _] = angles("2024-06-20T23:00:00Z", 40.0, 0.0);
        assert!(night < -20.0, "{night}");
    }

    #[test]
    fn dates_are_counted_through_leap_years() {
        assert_eq!(days(2000, 1, 1), 0.0);
        assert_eq!(days(2000, 3, 1) - days(2000, 2, 28), 2.0);
        assert_eq!(days(1900, 3, 1) - days(1900, 2, 28), 1.0);
        assert_eq!(days(2025, 1, 1), 9132.0);
        assert_eq!(days(1970, 1, 1), -10_957.0);
    }
}
