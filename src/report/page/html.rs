//! HTML helpers.

/// Escapes text for HTML, including quoted attribute values.
pub(super) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c => out.push(c),
        }
    }
    out
}

/// Escapes JSON for a `script` element: replaces `<`, which could end the element and which occurs only in strings.
pub(super) fn json_in_script(json: &str) -> String {
    json.replace('<', "\\u003c")
}

/// Replaces each `{{name}}` in `template` by its value; the values themselves are not processed.
pub(super) fn fill(template: &str, values: &[(&str, &str)]) -> String {
    let mut parts = template.split("{{");
    let mut out = String::from(parts.next().unwrap_or_default());
    for part in parts {
        let (name, rest) = part.split_once("}}").expect("a name of the template ends");
        let value = values.iter().find(|v| v.0 == name).unwrap_or_else(|| panic!("`{name}` has no value"));
        out.push_str(value.1);
        out.push_str(rest);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_of_a_text_is_markup() {
        assert_eq!(escape("<a href=\"x\" b='&'>"), "&lt;a href=&quot;x&quot; b=&#39;&amp;&#39;&gt;");
        let json = json_in_script(r#"{"file":"</script>"}"#);
        assert_eq!(json, r#"{"file":"\u003c/script>"}"#);
        assert_eq!(serde_json::from_str::<serde_json::Value>(&json).unwrap()["file"], "</script>");
    }

    #[test]
    fn values_are_not_filled_again() {
        assert_eq!(fill("a {{x}} b {{y}}{{x}}", &[("x", "{{y}}"), ("y", "1")]), "a {{y}} b 1{{y}}");
    }
}
