#include "relight/shaping_files.h"

#include <list>
#include <mutex>
#include <system_error>

#include "image/image_io.h"

namespace relamp {
namespace {

namespace fs = std::filesystem;

/// The last files of one kind.
template <class Content>
class RecentFiles {
public:
    template <class Read>
    std::shared_ptr<const Content> of(const fs::path& file, const Read& read) {
        std::error_code missing;
        const uintmax_t size = fs::file_size(file, missing);
        const fs::file_time_type time = missing ? fs::file_time_type() : fs::last_write_time(file, missing);
        const std::lock_guard lock(mutex_);
        if (!missing)
            for (auto at = kept_.begin(); at != kept_.end(); ++at)
                if (at->file == file && at->size == size && at->time == time) {
                    kept_.splice(kept_.begin(), kept_, at);
                    return at->content;
                }
        auto content = std::make_shared<const Content>(read(file));
        std::erase_if(kept_, [&](const Kept& k) { return k.file == file; });
        kept_.push_front({file, size, time, content});
        if (kept_.size() > 16) kept_.pop_back();
        return content;
    }

private:
    struct Kept {
        fs::path file;
        uintmax_t size;
        fs::file_time_type time;
        std::shared_ptr<const Content> content;
    };
    std::mutex mutex_;
    std::list<Kept> kept_;
};

/// Boxes of pixels averaged until no side is too long.
Image smaller(const Image& image) {
    const int step = (std::max(image.width, image.height) + longestShapingSide - 1) / longestShapingSide;
    if (step <= 1) return image;
    Image out((image.width + step - 1) / step, (image.height + step - 1) / step);
    for (int y = 0; y < out.height; ++y)
        for (int x = 0; x < out.width; ++x) {
            Rgb sum(0);
            const int right = std::min((x + 1) * step, image.width), low = std::min((y + 1) * step, image.height);
            for (int v = y * step; v < low; ++v)
                for (int u = x * step; u < right; ++u) sum += image.at(u, v);
            out.at(x, y) = sum / float((right - x * step) * (low - y * step));
        }
    return out;
}

}  // namespace

std::shared_ptr<const IesProfile> iesOf(const fs::path& file) {
    static RecentFiles<IesProfile> recent;
    return recent.of(file, readIes);
}

std::shared_ptr<const ShapingImage> shapingImageOf(const fs::path& file) {
    static RecentFiles<ShapingImage> recent;
    return recent.of(file, [](const fs::path& f) {
        ShapingImage out{smaller(readImage(f, nullptr, false, size_t(1) << 26))};
        for (const Rgb& p : out.image.pixels) out.mean += p / float(out.image.pixels.size());
        return out;
    });
}

}  // namespace relamp
