//! The page as HTML: the template with its style, plots, data and program in their places.

use super::Page;

const TEMPLATE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
/// In the order in which they need each other.
const PROGRAM: [&str; 5] = [
    include_str!("robot.js"),
    include_str!("plots.js"),
    include_str!("answer.js"),
    include_str!("slider.js"),
    include_str!("page.js"),
];

impl Page {
    /// One file that needs nothing else.
    pub fn html(&self) -> String {
        // As text of HTML.
        let title = self.title.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        let parts: [(&str, &str); 6] = [
            ("{title}", &title),
            ("{style}", STYLE),
            ("{heading}", &title),
            ("{plots}", &self.svg),
            ("{data}", &self.data()),
            ("{program}", &PROGRAM.concat()),
        ];
        let (mut html, mut rest) = (String::new(), TEMPLATE);
        for (place, content) in parts {
            // Inserted text is never searched for further places.
            let (before, after) = rest.split_once(place).unwrap_or((rest, ""));
            html.extend([before, content]);
            rest = after;
        }
        html + rest
    }

    /// The data as JSON in which no sign means anything to HTML.
    fn data(&self) -> String {
        // Writing into memory cannot fail.
        let json = serde_json::to_string(self).unwrap_or_default();
        json.replace('<', "\\u003c").replace('>', "\\u003e").replace('&', "\\u0026")
    }
}
