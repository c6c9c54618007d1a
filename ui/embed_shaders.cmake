# Writes a C++ file with every shader as a string: relamp::ui::shaderSource("mesh.vert").
set(text "#include <cstring>\n#include \"viewport/shader_sources.h\"\n\nnamespace relamp::ui {\nnamespace {\nstruct Source { const char* name; const char* text; };\nconst Source sources[] = {\n")
foreach(file ${FILES})
  get_filename_component(name ${file} NAME)
  file(READ ${file} content)
  string(APPEND text "{\"${name}\", R\"relamp_shader(${content})relamp_shader\"},\n")
endforeach()
string(APPEND text "{nullptr, nullptr}};\n}  // namespace\n\nconst char* shaderSource(const char* name) {\n    for (const Source* s = sources; s->name; ++s)\n        if (std::strcmp(s->name, name) == 0) return s->text;\n    return nullptr;\n}\n\n}  // namespace relamp::ui\n")
file(WRITE ${OUTPUT} "${text}")
