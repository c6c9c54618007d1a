// The Nuke script that puts a frame together again from its light groups. Its nodes take their inputs from a stack, as
// every script of Nuke's does.
#include "shot/export_scene.h"

namespace relamp {

std::string nukeOf(const std::vector<std::string>& groups, LayerNaming naming, const std::string& frameFile) {
    LayerRequest request;
    request.groups = true;
    const std::vector<ChannelPart> parts = FrameLayers(request, naming, groups).parts(true);
    std::string s =
        "# Light groups of a frame of relamp render --layers groups, added up; each Grade is a light.\nversion "
        "13.0 v1\n";
    for (size_t i = 1; i < parts.size(); ++i)
        s += fmt::format("add_layer {{{0} {0}.red {0}.green {0}.blue}}\n", parts[i].name);
    s += fmt::format(
        "Read {{\n inputs 0\n file \"{}\"\n raw true\n name frame\n xpos 0\n ypos 0\n}}\nset frame [stack 0]\n",
        frameFile);
    int x = 0;
    for (size_t i = 1; i < parts.size(); ++i, x += 120) {
        const std::string& name = parts[i].name;
        if (i > 1) s += "push $frame\n";
        s += fmt::format("Shuffle {{\n in {0}\n alpha black\n name shuffle_{0}\n xpos {1}\n ypos 80\n}}\n", name, x);
        s += fmt::format("Grade {{\n multiply 1\n black_clamp false\n name light_{0}\n xpos {1}\n ypos 160\n}}\n", name,
                         x);
        if (i > 1)
            s += fmt::format(
                "Merge2 {{\n inputs 2\n operation plus\n output rgb\n name sum_{}\n xpos {}\n ypos {}\n}}\n", i - 1, x,
                240 + 60 * int(i));
    }
    // The frame's own alpha beside the sum.
    return s + fmt::format(
                   "push $frame\nCopy {{\n inputs 2\n from0 rgba.alpha\n to0 rgba.alpha\n name beauty\n xpos 0\n ypos "
                   "{}\n}}\n",
                   400 + 60 * int(parts.size()));
}

}  // namespace relamp
