//! What a glTF `uri` names: data inside the document or a file beside it.

use base64::Engine;
use base64::alphabet;
use base64::engine::DecodePaddingMode;
use base64::engine::general_purpose::{GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::{percent_decode, percent_decode_str};

/// A `uri`, decoded.
#[derive(Debug, PartialEq)]
pub(super) enum Uri {
    /// The bytes of a `data:` URI.
    Data(Vec<u8>),
    /// The name of a file, relative to the document.
    File(String),
}

impl Uri {
    /// Decodes a URI; percent-encoding in file names is undone.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub(super) fn parse(uri: &str) -> Result<Self, String> {
        let scheme = uri.get(..5).is_some_and(|start| start.eq_ignore_ascii_case("data:"));
        match uri.get(5..).filter(|_| scheme) {
            Some(data) => decode_data(data).map(Self::Data),
            None => {
                let file = percent_decode_str(uri).decode_utf8();
                let file = file.map_err(|_| format!("the file name {uri:?} is not UTF-8"))?;
                Ok(Self::File(file.into_owned()))
            }
        }
    }
}

fn decode_data(data: &str) -> Result<Vec<u8>, String> {
    const LENIENT: GeneralPurposeConfig =
        GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent);
    let (header, body) = data.split_once(',').ok_or("this data URI has no comma")?;
    if !header.to_ascii_lowercase().ends_with(";base64") {
        return Ok(percent_decode(body.as_bytes()).collect());
    }
    let engine = GeneralPurpose::new(&alphabet::STANDARD, LENIENT);
    engine.decode(body.trim()).map_err(|cause| format!("this data URI is broken: {cause}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_and_files_are_told_apart() {
        let data = |uri| Uri::parse(uri).unwrap();
        assert_eq!(data("data:;base64,AQID"), Uri::Data(vec![1, 2, 3]));
        assert_eq!(data("DATA:image/png;BASE64,AQI"), Uri::Data(vec![1, 2]));
        assert_eq!(data("data:text/plain,a%20b"), Uri::Data(b"a b".to_vec()));
        assert_eq!(data("a%20b%C3%A9.bin"), Uri::File("a bé.bin".into()));
        assert_eq!(data("dåta"), Uri::File("dåta".into()));
    }

    #[test]
    fn broken_ones_are_refused() {
        assert!(Uri::parse("data:;base64,A*ID").unwrap_err().contains("is broken"));
        assert!(Uri::parse("data:;base64").unwrap_err().contains("no comma"));
        assert!(Uri::parse("%ff.bin").unwrap_err().contains("not UTF-8"));
    }
}
