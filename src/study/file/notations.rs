//! Reads values that have more than one notation, such as a number or a list.

/// Implements `Deserialize` for a type: what is expected, in words, and for each notation what it becomes; `None` refuses
/// the value. Numbers are `f64`, natural numbers `u64`, texts `&str`; a list or a map names the type of its content.
macro_rules! notations {
    ($type:ty: $expected:literal, $($notation:ident $(($content:ty))? => $become:expr),+ $(,)?) => {
        impl<'de> serde::Deserialize<'de> for $type {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                struct ByNotation;
                impl<'de> serde::de::Visitor<'de> for ByNotation {
                    type Value = $type;

                    fn expecting(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                        out.write_str($expected)
                    }

                    $(notations!(@$notation $(($content))? $become);)+
                }
                deserializer.deserialize_any(ByNotation)
            }
        }
    };
    (@number $become:expr) => {
        fn visit_u64<E: serde::de::Error>(self, number: u64) -> Result<Self::Value, E> {
            self.visit_f64(number as f64)
        }

        fn visit_f64<E: serde::de::Error>(self, number: f64) -> Result<Self::Value, E> {
            let found = serde::de::Unexpected::Float(number);
            ($become)(number).ok_or_else(|| E::invalid_value(found, &self))
        }
    };
    (@natural $become:expr) => {
        fn visit_u64<E: serde::de::Error>(self, number: u64) -> Result<Self::Value, E> {
            let found = serde::de::Unexpected::Unsigned(number);
            ($become)(number).ok_or_else(|| E::invalid_value(found, &self))
        }
    };
    (@text $become:expr) => {
        fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Self::Value, E> {
            let found = serde::de::Unexpected::Str(text);
            ($become)(text).ok_or_else(|| E::invalid_value(found, &self))
        }
    };
    (@list ($content:ty) $become:expr) => {
        fn visit_seq<A: serde::de::SeqAccess<'de>>(self, list: A) -> Result<Self::Value, A::Error> {
            let list = serde::de::value::SeqAccessDeserializer::new(list);
            <$content as serde::Deserialize>::deserialize(list).map($become)
        }
    };
    (@map ($content:ty) $become:expr) => {
        fn visit_map<A: serde::de::MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
            let map = serde::de::value::MapAccessDeserializer::new(map);
            <$content as serde::Deserialize>::deserialize(map).map($become)
        }
    };
}

pub(super) use notations;
