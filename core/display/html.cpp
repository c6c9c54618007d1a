#include "display/html.h"

#include <fmt/format.h>

#include <cstdint>

#include "image/image_io.h"

namespace relamp {

std::string htmlText(const std::string& text) {
    std::string safe;
    for (char c : text) {
        switch (c) {
            case '&': safe += "&amp;"; break;
            case '<': safe += "&lt;"; break;
            case '>': safe += "&gt;"; break;
            case '"': safe += "&quot;"; break;
            default: safe += c;
        }
    }
    return safe;
}

std::string base64(const std::string& bytes) {
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t triple = 0;
        for (size_t k = 0; k < 3; ++k) triple = triple << 8 | (i + k < bytes.size() ? uint8_t(bytes[i + k]) : 0u);
        for (size_t k = 0; k < 4; ++k) text += k <= bytes.size() - i ? letters[triple >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

std::string htmlImage(const Image& image, const std::string& caption, const std::string& about) {
    return fmt::format(
        "<figure><img width=\"{}\" height=\"{}\" alt=\"{}\" src=\"data:image/png;base64,{}\"><figcaption><b>{}</b> "
        "{}</figcaption></figure>\n",
        image.width, image.height, htmlText(caption), base64(encodePng(image)), htmlText(caption), htmlText(about));
}

std::string htmlPage(const std::string& title, const std::string& part) {
    static const char style[] = R"(
:root { color-scheme: dark; }
body { margin: 0; background: #1e1e1e; color: #d2d2d2; font: 15px/1.5 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; }
main { max-width: 1500px; margin: 0 auto; padding: 28px 32px 64px; }
h1 { font-size: 26px; font-weight: 600; margin: 0 0 4px; color: #f0f0f0; }
h2 { font-size: 19px; font-weight: 600; margin: 44px 0 2px; color: #f0f0f0; }
h3 { font-size: 15px; font-weight: 600; margin: 26px 0 8px; color: #e2e2e2; }
p { margin: 4px 0 14px; max-width: 92ch; color: #b4b4b4; }
.grid { display: grid; gap: 14px; align-items: start; }
.two { grid-template-columns: repeat(2, minmax(0, 1fr)); }
.one { grid-template-columns: minmax(0, 700px); }
.three { grid-template-columns: repeat(3, minmax(0, 1fr)); }
.four { grid-template-columns: repeat(4, minmax(0, 1fr)); }
figure { margin: 0; }
img { display: block; width: 100%; height: auto; background: #2a2a2a; border-radius: 3px; }
figcaption { margin-top: 5px; font-size: 13px; line-height: 1.4; color: #a6a6a6; }
figcaption b { color: #dedede; font-weight: 600; }
table { border-collapse: collapse; margin: 8px 0; }
th, td { text-align: left; vertical-align: top; padding: 6px 22px 6px 0; border-bottom: 1px solid #383838; }
th { white-space: nowrap; color: #e6e6e6; font-weight: 600; }
td small { display: block; color: #979797; font-size: 12.5px; }
td.number { font-variant-numeric: tabular-nums; white-space: nowrap; color: #ececec; }
.swatch { display: inline-block; width: 14px; height: 14px; border-radius: 7px; vertical-align: -2px; margin-right: 7px; border: 1px solid #555; }
.wide { overflow-x: auto; }
svg { max-width: 100%; height: auto; display: block; margin-top: 6px; }
@media (max-width: 800px) { main { padding: 16px; } .four { grid-template-columns: repeat(2, minmax(0, 1fr)); } .two { grid-template-columns: 1fr; } }
)";
    return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
           "content=\"width=device-width, initial-scale=1\"><title>" +
           htmlText(title) + "</title><style>" + style + "</style></head>\n<body><main>\n" + part +
           "</main></body></html>\n";
}

}  // namespace relamp
