#include "gui.h"

#include <epoxy/gl.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>
#include <vector>

#include "backends/imgui_impl_glfw.h"
#include "backends/imgui_impl_opengl3.h"
#include "base/is_there.h"
#include "changed_parts.h"
#include "theme.h"
#include "viewport/gl_objects.h"
#include "widgets.h"
#include "window.h"

namespace relamp::ui {
namespace {

constexpr float fontPixels = 15;

/// A readable sans serif that the system has; ImGui's own when there is none.
std::filesystem::path fontFile() {
    for (const char* file :
         {"/usr/share/fonts/opentype/inter/Inter-Regular.otf", "/usr/share/fonts/truetype/inter/Inter-Regular.ttf",
          "/usr/share/fonts/opentype/inter/Inter-Regular.ttf", "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
          "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf"})
        if (isThere(file)) return file;
    return {};
}

void buildFonts(float pixels) {
    ImGuiIO& io = ImGui::GetIO();
    io.Fonts->Clear();
    // Latin, Latin Extended-A, Greek, general punctuation, arrows, a few mathematical signs.
    static const ImWchar ranges[] = {0x20,   0xff,   0x100,  0x17f,  0x370,  0x3ff,  0x2010, 0x2027, 0x2030,
                                     0x205e, 0x2190, 0x2195, 0x2212, 0x2212, 0x2248, 0x2265, 0};
    const std::filesystem::path file = fontFile();
    ImFontConfig config;
    config.OversampleH = 2;
    config.OversampleV = 1;
    if (file.empty() || !io.Fonts->AddFontFromFileTTF(file.c_str(), pixels, &config, ranges)) {
        ImFontConfig plain;
        plain.SizePixels = pixels;
        io.Fonts->AddFontDefault(&plain);
    }
}

}  // namespace

/// The interface as it was drawn last, in an image of its own.
struct KeptInterface {
    GlTarget target;
    ChangedParts parts;
    bool holds = false;  ///< the last frame was drawn into it
};

Gui::Gui(Window& window) : window_(window), kept_(std::make_unique<KeptInterface>()) {
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.LogFilename = nullptr;
    io.ConfigWindowsMoveFromTitleBarOnly = true;
    ImGui_ImplGlfw_InitForOpenGL(window.handle(), true);
    window.holdKeys();
#if IMGUI_VERSION_NUM >= 18700
    // Which events make up a frame is Window's to say: ImGui would spread typed words over as many frames as letters.
    io.ConfigInputTrickleEventQueue = false;
#endif
    ImGui_ImplOpenGL3_Init("#version 330");
}

Gui::~Gui() {
    kept_.reset();
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
}

void Gui::setScale(float scale, float density) {
    if (scale == scale_ && density == density_) return;
    scale_ = scale;
    density_ = density;
    buildFonts(fontPixels * scale * density);
    ImGui::GetIO().FontGlobalScale = 1 / density;
    ImGui_ImplOpenGL3_DestroyFontsTexture();
    ImGui_ImplOpenGL3_CreateFontsTexture();
    applyTheme(scale);
}

namespace {

/// Newer versions of ImGui ask the keyboard which modifiers are down; a held event knows which were.
void holdModifiers([[maybe_unused]] const RawKey& k) {
#if IMGUI_VERSION_NUM >= 18900
    ImGuiIO& io = ImGui::GetIO();
    io.AddKeyEvent(ImGuiMod_Ctrl, k.control);
    io.AddKeyEvent(ImGuiMod_Shift, k.shift);
    io.AddKeyEvent(ImGuiMod_Alt, k.alt);
#endif
}

}  // namespace

void Gui::beginFrame(bool menuKeys) {
    ImGui_ImplOpenGL3_NewFrame();
    for (const RawKey& k : window_.takeRawKeys()) {
        if (k.character) ImGui_ImplGlfw_CharCallback(window_.handle(), k.character);
        else {
            ImGui_ImplGlfw_KeyCallback(window_.handle(), k.key, k.scancode, k.action, k.modifiers);
            holdModifiers(k);
        }
    }
    ImGui_ImplGlfw_NewFrame();
    ImGuiIO& io = ImGui::GetIO();
    for (const RawButton& b : window_.takeButtons()) {
#if IMGUI_VERSION_NUM < 18700
        down_[b.button] = b.down;
#else
        io.AddMouseButtonEvent(b.button, b.down);
#endif
        if (!b.down) continue;
        io.MouseDoubleClickTime = clicks_.second(b.button, b.seconds) ? 1e6f : 0.0f;
    }
#if IMGUI_VERSION_NUM < 18700
    std::copy(std::begin(down_), std::end(down_), io.MouseDown);
#endif
    escapeUsed_ = beginGuiFrame(menuKeys);
}

void Gui::drawChanged(int width, int height, uint64_t changing) {
    ImDrawData& data = *ImGui::GetDrawData();
    if (!std::exchange(kept_->holds, true) || kept_->target.width != width || kept_->target.height != height)
        kept_->parts.forget();
    kept_->target.resize(width, height, GL_RGBA8, 0, GL_NEAREST);
    glBindFramebuffer(GL_FRAMEBUFFER, kept_->target.framebuffer.id());
    glClearColor(0.1f, 0.1f, 0.1f, 1);
    const ImVec2 density = data.FramebufferScale;
    std::vector<ImVec4> clips;
    for (int i = 0; i < data.CmdListsCount; ++i)
        for (const ImDrawCmd& command : data.CmdLists[i]->CmdBuffer) clips.push_back(command.ClipRect);
    for (const ChangedPart& part : kept_->parts.next(data, textureId(changing))) {
        const int left = int(part.low.x * density.x), right = int(std::ceil(part.high.x * density.x)),
                  top = int(part.low.y * density.y), bottom = int(std::ceil(part.high.y * density.y));
        glEnable(GL_SCISSOR_TEST);
        glScissor(left, height - bottom, right - left, bottom - top);
        glClear(GL_COLOR_BUFFER_BIT);
        glDisable(GL_SCISSOR_TEST);
        size_t clip = 0;
        for (int i = 0; i < data.CmdListsCount; ++i)
            for (ImDrawCmd& command : data.CmdLists[i]->CmdBuffer) {
                const ImVec4& whole = clips[clip++];
                command.ClipRect = {std::max(whole.x, part.low.x), std::max(whole.y, part.low.y),
                                    std::min(whole.z, part.high.x), std::min(whole.w, part.high.y)};
            }
        ImGui_ImplOpenGL3_RenderDrawData(&data);
    }
    glBindFramebuffer(GL_READ_FRAMEBUFFER, kept_->target.framebuffer.id());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    glBlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

void Gui::endFrame(int framebufferWidth, int framebufferHeight, uint64_t changing) {
    ImGui::Render();
    if (changing) return drawChanged(framebufferWidth, framebufferHeight, changing);
    kept_->holds = false;
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, framebufferWidth, framebufferHeight);
    glClearColor(0.1f, 0.1f, 0.1f, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void Gui::skipFrame() { ImGui::EndFrame(); }

bool Gui::typing() const { return ImGui::GetIO().WantTextInput; }
bool Gui::popupOpen() const { return ImGui::GetCurrentContext()->OpenPopupStack.Size > 0; }

namespace {

/// Where nothing is marked yet, the first arrow marks the first item of a menu, and does not pass it. True until it is
/// up again.
bool marksFirst([[maybe_unused]] bool menu) {
#if IMGUI_VERSION_NUM < 18700
    static bool holding = false;
    ImGuiContext& g = *ImGui::GetCurrentContext();
    bool arrow = false;
    for (const ImGuiKey key : {ImGuiKey_UpArrow, ImGuiKey_DownArrow})
        arrow |= g.IO.KeyMap[key] >= 0 && g.IO.KeysDown[g.IO.KeyMap[key]];
    holding = menu && arrow && (holding || (g.NavDisableHighlight && g.NavId != 0));
    return holding;
#else
    return false;
#endif
}

}  // namespace

bool beginGuiFrame(bool menuKeys) {
    ImGuiContext& g = *ImGui::GetCurrentContext();
    const int open = g.OpenPopupStack.Size;
    const ImGuiWindow* top = open > 0 ? g.OpenPopupStack.back().Window : nullptr;
    const bool menu = menuKeys && top && !(top->Flags & ImGuiWindowFlags_Modal);
    // A number or a text in it that is being changed keeps its keys.
    const bool first = marksFirst(menu && g.ActiveId == 0), moves = menu && g.ActiveId == 0 && !first;
    if (moves) {
        g.IO.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
    } else if (g.IO.ConfigFlags & ImGuiConfigFlags_NavEnableKeyboard) {
        g.IO.ConfigFlags &= ~ImGuiConfigFlags_NavEnableKeyboard;
        if (!menu) g.NavDisableHighlight = true, g.NavDisableMouseHover = false;
    }
#if IMGUI_VERSION_NUM < 18700
    // It has Space alone for this.
    if (const int enter = g.IO.KeyMap[ImGuiKey_Enter]; moves && enter >= 0 && g.IO.KeysDown[enter])
        g.IO.NavInputs[ImGuiNavInput_Activate] = 1;
#endif
    ImGui::NewFrame();
    if (first) g.NavDisableHighlight = false, g.NavDisableMouseHover = true;
    const bool closed = moves && g.OpenPopupStack.Size < open;
    if (closed) menuTookEscape();
    return closed;
}

void createHeadlessGui(float width, float height) {
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.DisplaySize = ImVec2(width, height);
    buildFonts(fontPixels);
    unsigned char* pixels = nullptr;
    int w = 0, h = 0;
    io.Fonts->GetTexDataAsRGBA32(&pixels, &w, &h);
    applyTheme(1);
}

void destroyHeadlessGui() { ImGui::DestroyContext(); }

}  // namespace relamp::ui
