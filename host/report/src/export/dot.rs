//! The mechanism as a graph for Graphviz: links are nodes, joints are edges.

use fivebar_files::robot::Robot;

/// The mechanism as a graph for Graphviz. Driven joints are bold.
pub fn dot(robot: &Robot) -> String {
    let [l1, l2, l3, l4, base] = robot.geometry.lengths();
    let name = robot.name.replace('\\', "\\\\").replace('"', "\\\"");
    format!(
        "graph \"{name}\" {{\n  layout = circo;\n  node [shape = box];\n\
         \x20 ground [label = \"ground\\n{base} m\"];\n  link1 [label = \"link 1\\n{l1} m\"];\n\
         \x20 link2 [label = \"link 2\\n{l2} m\"];\n  link3 [label = \"link 3\\n{l3} m\"];\n\
         \x20 link4 [label = \"link 4\\n{l4} m\"];\n\
         \x20 ground -- link1 [label = \"A\", style = bold];\n  link1 -- link2 [label = \"B\"];\n\
         \x20 link2 -- link3 [label = \"C\"];\n  link3 -- link4 [label = \"D\"];\n\
         \x20 link4 -- ground [label = \"E\", style = bold];\n}}\n"
    )
}
