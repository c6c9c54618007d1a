// The files of shaders/, embedded at build.
#pragma once

namespace relamp::ui {

/// Text of shaders/NAME; null when there is none.
const char* shaderSource(const char* name);

}  // namespace relamp::ui
