//! Hostile drawings in SVG.

use crate::{Input, Kind, counted, kind};

pub(crate) fn page(content: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" \
         width=\"80mm\" height=\"60mm\">{content}</svg>"
    )
}

#[expect(clippy::too_many_lines, reason = "a list of files")]
pub(crate) fn kinds() -> Vec<Kind> {
    const SEEN: &str = "fill=\"none\" stroke=\"red\"";
    let mut kinds: Vec<Kind> = Vec::new();
    for (name, part, count) in [
        ("elements", "<g/>", 300_000),
        ("open elements", "<g>", 100_000),
        ("comments", "<!---->", 300_000),
        ("circles", "<circle r=\"9e8\"/>", 20_000),
        ("texts", "<text>a</text>", 20_000),
        (
            "pieces of a text",
            "<text><tspan>a</tspan><tspan>b</tspan></text>",
            900,
        ),
        (
            "colours",
            "<path d=\"M0 0L9 9\" stroke=\"#####\" fill=\"none\"/>",
            10_000,
        ),
        (
            "pictures",
            "<image xlink:href=\"data:image/png;base64,AAAA\" width=\"9\" height=\"9\"/>",
            9_000,
        ),
        ("filters", "<filter id=\"f\"><feFlood/></filter>", 20_000),
        (
            "gradients",
            "<linearGradient id=\"a#\" xlink:href=\"#a#\"/>",
            20_000,
        ),
        (
            "clips",
            "<clipPath id=\"c\" clip-path=\"url(#c)\"><path d=\"M0 0L9 9\"/></clipPath>",
            9_000,
        ),
        (
            "dashes",
            "<path d=\"M0 0L1e6 1e6\" stroke=\"red\" stroke-dasharray=\"1e-9\"/>",
            900,
        ),
        (
            "scales",
            "<g transform=\"scale(1e30)\"><path d=\"M0 0Q1 9 9 9\"/></g>",
            9_000,
        ),
    ] {
        kinds.push(kind(format!("svg: {name}"), move || {
            page(&part.repeat(counted(count)))
        }));
    }
    for (name, part, count) in [
        ("levels of a path", "h1", 2_000_000),
        ("moves of a path", "M0 0", 300_000),
        ("arcs of a path", "a9e5 9e5 0 1 1 9 9", 20_000),
        ("curves of a path", "q9e6 9e6 0 9e6", 9_000),
        ("closings of a path", "l1 1z", 200_000),
        ("digits of a path", "1", 400_000),
    ] {
        let text = move || {
            page(&format!(
                "<path {SEEN} d=\"M0 0{}\"/>",
                part.repeat(counted(count))
            ))
        };
        kinds.push(kind(format!("svg: {name}"), text));
    }
    let doubled = |tag: &'static str| {
        move || {
            let levels = (1..30).map(|n| {
                let inner = n - 1;
                format!("<{tag} id=\"a{n}\"><use xlink:href=\"#a{inner}\"/><use xlink:href=\"#a{inner}\"/></{tag}>")
            });
            let levels: String = levels.collect();
            page(&format!(
                "<defs><path id=\"a0\" d=\"M0 0L1 1\"/>{levels}</defs><use xlink:href=\"#a29\"/>"
            ))
        }
    };
    kinds.push(kind("svg: groups that double", doubled("g")));
    kinds.push(kind("svg: symbols that double", doubled("symbol")));
    let entities = |value: String, count: usize| {
        let body = page(&"&a;".repeat(counted(count)));
        format!("<!DOCTYPE svg [<!ENTITY a \"{value}\">]>{body}")
    };
    kinds.push(kind("svg: a long entity", move || {
        entities("x".repeat(10_000), 10_000)
    }));
    kinds.push(kind("svg: an entity of elements", move || {
        entities("<path d='M0 0L9 9'/>".repeat(100), 5_000)
    }));
    kinds.push(kind("svg: a billion laughs", || {
        let levels =
            (1..10).map(|n| format!("<!ENTITY e{n} \"{}\">", format!("&e{};", n - 1).repeat(10)));
        let levels: String = levels.collect();
        format!(
            "<!DOCTYPE svg [<!ENTITY e0 \"ha\">{levels}]>{}",
            page("<text>&e9;</text>")
        )
    }));
    kinds.push(kind("svg: attributes", || {
        let attributes: String = (0..counted(20_000))
            .map(|n| format!(" a{n}=\"\""))
            .collect();
        page(&format!("<g{attributes}/>"))
    }));
    kinds.push(kind("svg: rules of style", || {
        let rules = ".c{fill:red}".repeat(counted(5_000));
        page(&format!(
            "<style>{rules}</style>{}",
            "<g class=\"c\"/>".repeat(counted(5_000))
        ))
    }));
    kinds.push(kind("svg: markers", || {
        let marker = "<marker id=\"m\"><path d=\"M0 0L9 9\"/></marker>";
        let path = "L5 5L6 9".repeat(counted(50_000));
        page(&format!(
            "{marker}<path marker-mid=\"url(#m)\" d=\"M0 0{path}\"/>"
        ))
    }));
    let square = "<path d=\"M0 0H9000V9000H0Z\"/>";
    let hatched = move || Input::Hatched(page(square), 1e-7);
    kinds.push(("svg: a fine hatch".into(), Box::new(hatched)));
    let stacked = move || Input::Hatched(page(&square.repeat(counted(3_000))), 1e-3);
    kinds.push(("svg: hatches above each other".into(), Box::new(stacked)));
    kinds.extend(outlines());
    kinds.extend(references());
    kinds
}

/// Lines whose outlines are long.
fn outlines() -> Vec<Kind> {
    let mut kinds: Vec<Kind> = Vec::new();
    for (name, content, count) in [
        (
            "curves as wide as the sea",
            "<path d=\"M0 0C1 9 5 9 9 0\" stroke=\"red\" stroke-width=\"1e9\"/>",
            5_000,
        ),
        (
            "circles with an outline",
            "<circle r=\"1e5\" stroke=\"red\" style=\"stroke-width:1e8\"/>",
            5_000,
        ),
        (
            "curves that are turned and large",
            "<path transform=\"rotate(30) scale(1e6)\" d=\"M0 0C1 9 5 9 9 0\" stroke=\"red\"/>",
            5_000,
        ),
        (
            "wide letters",
            "<text font-size=\"1e5\" stroke=\"red\" stroke-width=\"1e5\">@</text>",
            900,
        ),
        (
            "curves and lines of no width",
            "<path d=\"M0 0C1 9 5 9 9 0\" stroke=\"red\" stroke-width=\"1e9\"/>\
             <path d=\"M0 0L9 9\" stroke=\"red\" stroke-width=\"0\"/>",
            5_000,
        ),
        (
            "curves with markers",
            "<path d=\"M0 0C1e5 9e5 5e5 9e5 9e5 0\" stroke=\"red\" marker-end=\"url(#m)\"/>",
            5_000,
        ),
        (
            "a mask of wide curves",
            "<mask id=\"k\"><path d=\"M0 0C1 9 5 9 9 0\" stroke=\"red\" stroke-width=\"1e9\"/></mask>\
             <path d=\"M0 0L9 9\" mask=\"url(#k)\" stroke=\"red\"/>",
            2_000,
        ),
        (
            "a pattern of wide curves",
            "<pattern id=\"p\" width=\"9\" height=\"9\"><path d=\"M0 0C1 9 5 9 9 0\" stroke=\"red\" \
             stroke-width=\"1e9\"/></pattern><path d=\"M0 0h9v9z\" fill=\"url(#p)\"/>",
            2_000,
        ),
        (
            "dots with dashes",
            "<path d=\"M0 0Q1e5 9e5 5e5 9\" stroke=\"red\" stroke-dasharray=\"1e-3\" stroke-width=\"1e-9\"/>",
            5_000,
        ),
    ] {
        kinds.push(kind(format!("svg: {name}"), move || {
            let marker = "<marker id=\"m\"><path d=\"M0 0Q1 9 9 9\" stroke=\"red\"/></marker>";
            page(&format!("{marker}{}", content.repeat(counted(count))))
        }));
    }
    kinds
}

/// Elements that others refer to, in levels.
#[expect(clippy::too_many_lines, reason = "a list of files")]
fn references() -> Vec<Kind> {
    let mut kinds: Vec<Kind> = Vec::new();
    // Each level has two references to the one within it; `?` is its number, `@` that of the inner one.
    for (name, level, last) in [
        (
            "patterns in patterns",
            "<pattern id=\"a?\" width=\"9\" height=\"9\"><path d=\"M0 0h9v9z\" fill=\"url(#a@)\"/>\
             <path d=\"M0 0h9v9z\" stroke=\"url(#a@)\"/></pattern>",
            "fill=\"url(#a29)\"",
        ),
        (
            "clips of clips",
            "<clipPath id=\"a?\" clip-path=\"url(#a@)\"><path d=\"M0 0h9v9z\" clip-path=\"url(#a@)\"/></clipPath>",
            "clip-path=\"url(#a29)\"",
        ),
        (
            "masks of masks",
            "<mask id=\"a?\" mask=\"url(#a@)\"><path d=\"M0 0h9v9z\" mask=\"url(#a@)\"/></mask>",
            "mask=\"url(#a29)\"",
        ),
        (
            "filters of pictures",
            "<g id=\"a?\"><use xlink:href=\"#a@\"/></g><filter id=\"f?\"><feImage xlink:href=\"#a@\"/></filter>\
             <path d=\"M0 0h9v9z\" filter=\"url(#f?)\"/>",
            "filter=\"url(#f29)\"",
        ),
        (
            "markers on markers",
            "<marker id=\"a?\"><path d=\"M0 0L9 9L1 1\" marker-mid=\"url(#a@)\" marker-end=\"url(#a@)\" \
             stroke=\"red\"/></marker>",
            "stroke=\"red\" marker-end=\"url(#a29)\"",
        ),
    ] {
        kinds.push(kind(format!("svg: {name}"), move || {
            let levels = (1..30).map(|n: i32| {
                let level = level.replace('?', &n.to_string());
                level.replace('@', &(n - 1).to_string())
            });
            let levels: String = levels.collect();
            let inner = "<path id=\"a0\" d=\"M0 0h9v9z\"/>";
            page(&format!("{inner}{levels}<path d=\"M0 0h9v9z\" {last}/>"))
        }));
    }
    for (name, head, part, count) in [
        (
            "a selector of descendants",
            "g g g g g g g g g path{stroke:red}",
            "<g><path d=\"M0 0L9 9\"/></g>",
            20_000,
        ),
        (
            "a long selector",
            "[a^='b'][c*='d'] > g > path:first-child, path{stroke:red}",
            "<path class=\"a b c d e f\" d=\"M0 0L9 9\"/>",
            20_000,
        ),
        (
            "transforms",
            "path{stroke:red}",
            "<g transform=\"rotate(1)scale(1)skewX(1)translate(1)matrix(1 0 0 1 0 0)\"><path d=\"M0 0L9 9\"/></g>",
            10_000,
        ),
        (
            "pictures in base64",
            "path{stroke:red}",
            "<image width=\"9\" height=\"9\" xlink:href=\"data:image/png;base64,?\"/>",
            9,
        ),
        (
            "drawings in pictures",
            "path{stroke:red}",
            "<image width=\"9\" height=\"9\" xlink:href=\"data:image/svg+xml;utf8,&lt;svg xmlns='http://www.w3.org/2000/svg'/>\"/>",
            9_000,
        ),
        (
            "texts on paths",
            "text{stroke:red}",
            "<path id=\"t\" d=\"M0 0C1e6 9e6 5e6 9 9 0\"/><text><textPath xlink:href=\"#t\">a b c</textPath></text>",
            900,
        ),
        (
            "switches",
            "path{stroke:red}",
            "<switch><g systemLanguage=\"a,b,c\"/><path d=\"M0 0L9 9\"/></switch>",
            20_000,
        ),
        (
            "drawings in a drawing",
            "path{stroke:red}",
            "<svg viewBox=\"0 0 1e-9 1e-9\"><path d=\"M0 0L9 9\"/></svg>",
            15_000,
        ),
    ] {
        kinds.push(kind(format!("svg: {name}"), move || {
            let part = part.replace('?', &"QUJD".repeat(counted(200_000)));
            page(&format!(
                "<style>{head}</style>{}",
                part.repeat(counted(count))
            ))
        }));
    }
    for tag in ["g", "svg", "a", "switch", "clipPath"] {
        kinds.push(kind(format!("svg: levels of {tag}"), move || {
            let opened = format!("<{tag}>").repeat(1_000);
            let closed = format!("</{tag}>").repeat(1_000);
            page(&format!("{opened}<path d=\"M0 0L9 9\"/>{closed}"))
        }));
    }
    kinds
}
