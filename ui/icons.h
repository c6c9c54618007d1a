// Icons as strokes, so that no font has to carry them and every size is sharp.
#pragma once
#include <imgui.h>

#include <string>

namespace relamp::ui {

enum class Icon {
    none,
    eyeOpen,
    eyeShut,
    solo,
    reset,
    plus,
    minus,
    trash,
    copy,
    folder,
    file,
    image,
    film,
    capture,
    shot,
    up,
    home,
    back,
    warning,
    play,
    pause,
    stop,
    aim,
    mirror,
    spot,
    link,
    search,
    dots,
    emitter,
    rectangle,
    disk,
    sphere,
    mesh,
    sun,
    dropper,
    check,
    cross,
    pin
};

/// The icon that a table of core names; `emitter` where there is none of that name.
Icon iconNamed(const std::string& name);

/// Inside the square of `size` pixels whose top left corner is `at`.
void drawIcon(ImDrawList* list, Icon icon, const ImVec2& at, float size, ImU32 colour);

}  // namespace relamp::ui
