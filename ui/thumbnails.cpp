#include "thumbnails.h"

namespace relamp::ui {
namespace {
ThumbnailMaker makerInUse;
std::function<void(const std::string&)> dropperInUse;
}  // namespace

void setThumbnailMaker(ThumbnailMaker maker) { makerInUse = std::move(maker); }
uint64_t thumbnail(const std::string& key, const std::function<Image()>& make) {
    return makerInUse ? makerInUse(key, make) : 0;
}
void setThumbnailDropper(std::function<void(const std::string&)> dropper) { dropperInUse = std::move(dropper); }
void dropThumbnails(const std::string& prefix) {
    if (dropperInUse) dropperInUse(prefix);
}

}  // namespace relamp::ui
