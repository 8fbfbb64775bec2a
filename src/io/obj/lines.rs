use std::borrow::Cow;

/// The lines of a file as OBJ means them: with the number of the line (from 1), ends of any kind (LF,
/// CRLF, CR), a backslash at the end joining the next line on, and comments taken off. Bytes that are not
/// UTF-8 become replacement characters: they can only be in names or comments of a good file.
pub(super) fn logical_lines(bytes: &[u8]) -> LogicalLines<'_> {
    let rest = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    LogicalLines { rest, number: 0 }
}

pub(super) struct LogicalLines<'a> {
    rest: &'a [u8],
    number: usize,
}

impl<'a> LogicalLines<'a> {
    fn physical(&mut self) -> Option<Cow<'a, str>> {
        if self.rest.is_empty() {
            return None;
        }
        self.number += 1;
        let end = self.rest.iter().position(|&b| b == b'\n' || b == b'\r').unwrap_or(self.rest.len());
        let (line, tail) = self.rest.split_at(end);
        self.rest = tail.strip_prefix(b"\r\n").unwrap_or(tail.get(1..).unwrap_or_default());
        Some(String::from_utf8_lossy(line))
    }
}

impl<'a> Iterator for LogicalLines<'a> {
    type Item = (usize, Cow<'a, str>);

    fn next(&mut self) -> Option<Self::Item> {
        let mut line = self.physical()?;
        let number = self.number;
        loop {
            // A comment ends with its line, backslash or not.
            if let Some(comment) = line.find('#') {
                line = match line {
                    Cow::Borrowed(text) => Cow::Borrowed(&text[..comment]),
                    Cow::Owned(mut text) => {
                        text.truncate(comment);
                        Cow::Owned(text)
                    }
                };
                return Some((number, line));
            }
            match line.trim_end().strip_suffix('\\') {
                None => return Some((number, line)),
                Some(start) => {
                    let next = self.physical().unwrap_or_default();
                    line = Cow::Owned(format!("{start} {next}"));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(bytes: &[u8]) -> Vec<(usize, String)> {
        logical_lines(bytes).map(|(number, line)| (number, line.trim().to_owned())).collect()
    }

    fn owned(expected: &[(usize, &str)]) -> Vec<(usize, String)> {
        expected.iter().map(|&(number, line)| (number, line.to_owned())).collect()
    }

    #[test]
    fn every_kind_of_line_end() {
        assert_eq!(lines(b"a\nb\r\n\nc\rd"), owned(&[(1, "a"), (2, "b"), (3, ""), (4, "c"), (5, "d")]));
        assert_eq!(lines(b"\xef\xbb\xbfv 1\n"), owned(&[(1, "v 1")]));
        assert_eq!(lines(b""), []);
    }

    #[test]
    fn continuation_and_comments() {
        assert_eq!(lines(b"f 1 2 \\\r\n 3\\\n4\ng"), owned(&[(1, "f 1 2   3 4"), (4, "g")]));
        assert_eq!(lines(b"# C:\\\nv 1 # x\\\nf\\"), owned(&[(1, ""), (2, "v 1"), (3, "f")]));
    }

    #[test]
    fn stray_bytes_are_replaced() {
        assert_eq!(lines(b"o caf\xe9\nv 1"), owned(&[(1, "o caf\u{fffd}"), (2, "v 1")]));
    }
}
