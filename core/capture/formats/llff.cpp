// LLFF's poses_bounds.npy: a numpy array with a row of 17 numbers for each image of the folder, in the order of names.
//
// From LLFF's README: the first 15 numbers are a matrix of 3 x 5, row-major: worldFromCamera with the axes down, right,
// back, then its position, then height, width and focal length of the image. The last two are depths. The principal
// point is the middle. numpy's format is documented in numpy.lib.format.
#include <array>
#include <bit>
#include <cstring>

#include "base/atomic_file.h"
#include "base/text_scanner.h"
#include "capture/formats/readers.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view magic("\x93NUMPY", 6);
constexpr size_t rowNumbers = 17;

bool isNumpyHead(std::string_view head) { return head.starts_with(magic); }

/// What follows 'KEY': in the header, up to `end`.
std::string_view entryOf(std::string_view header, std::string_view key, char end) {
    const size_t at = header.find(key);
    if (at == header.npos) throw Error("header: {} is missing", key);
    const size_t colon = header.find(':', at);
    if (colon == header.npos) throw Error("header: {} is missing", key);
    const size_t stop = header.find(end, colon);
    std::string_view entry = header.substr(colon + 1, stop == header.npos ? header.npos : stop - colon - 1);
    while (!entry.empty() && TextScanner::isSpace(entry.front())) entry.remove_prefix(1);
    return entry;
}

/// The rows of an N x 17 array of single or double numbers.
std::vector<std::array<double, rowNumbers>> rowsFrom(std::string_view bytes) {
    static_assert(std::endian::native == std::endian::little, "numbers are little-endian and read as they are");
    if (bytes.size() < 12 || !bytes.starts_with(magic)) throw Error("is no numpy array");
    const bool longHeader = bytes[6] >= 2;
    uint32_t length = 0;
    std::memcpy(&length, &bytes[8], longHeader ? 4 : 2);
    const size_t start = (longHeader ? 12 : 10) + size_t(length);
    if (start > bytes.size()) throw Error("header: is longer than the file");
    const std::string_view header = bytes.substr(10, start - 10);
    const std::string_view kind = entryOf(header, "'descr'", ',');
    const size_t size = kind == "'<f8'" ? 8 : kind == "'<f4'" ? 4 : 0;
    if (size == 0) throw Error("header: descr is {}, expected '<f8' or '<f4'", kind.substr(0, 40));
    if (!entryOf(header, "'fortran_order'", ',').starts_with("False"))
        throw Error("header: fortran_order is not False");
    const std::string_view shape = entryOf(header, "'shape'", ')');
    TextScanner words(shape.substr(std::min<size_t>(1, shape.size())));
    const auto count = TextScanner::integer(words.word()), width = TextScanner::integer(words.word());
    if (!count || *count < 1 || *count > int64_t(foreignViews) || width != int64_t(rowNumbers))
        throw Error("header: shape is {}), expected 1 to {} rows of 17", shape.substr(0, 40), foreignViews);
    if (bytes.size() - start != size_t(*count) * rowNumbers * size)
        throw Error("holds {} bytes of numbers, expected {}", bytes.size() - start, size_t(*count) * rowNumbers * size);
    std::vector<std::array<double, rowNumbers>> rows(static_cast<size_t>(*count));
    const char* at = bytes.data() + start;
    for (auto& row : rows)
        for (double& value : row) {
            float single = 0;
            std::memcpy(size == 8 ? static_cast<void*>(&value) : &single, at, size);
            if (size == 4) value = double(single);
            at += size;
        }
    return rows;
}

ForeignCameras parseLlff(const fs::path& file, const ForeignFolder& around, Progress& progress) {
    const auto rows = rowsFrom(readBytes(file, foreignFileBytes));
    const std::vector<std::string> names = around.photographs();
    if (names.size() != rows.size())
        throw Error("holds {} cameras, and the folder of images {} images: they belong together by their order",
                    rows.size(), names.size());
    ForeignCameras result;
    for (size_t i = 0; i < rows.size(); ++i)
        withContext(names[i], [&] {
            progress.check();
            const auto& m = rows[i];
            for (size_t k = 0; k < 15; ++k)
                if (!(std::abs(m[k]) <= 1e12)) throw Error("number {} is {}, expected a finite number", k, m[k]);
            const auto column = [&](size_t c) { return DVec3(m[c], m[5 + c], m[10 + c]); };
            ForeignView view{names[i], {}};
            setSize(view.camera, std::round(m[9]), std::round(m[4]));
            view.camera.focalX = view.camera.focalY = m[14];
            view.camera.centreX = 0.5 * view.camera.width, view.camera.centreY = 0.5 * view.camera.height;
            checkIntrinsics(view.camera, {"focal length", "focal length", "the middle's x", "the middle's y"});
            view.camera.worldFromCamera =
                poseFromOpenGl(glm::dmat3(column(1), -column(0), column(2)), column(3), "pose");
            result.views.push_back(std::move(view));
        });
    return result;
}

std::optional<fs::path> findLlff(const fs::path& folder) {
    const fs::path file = folder / "poses_bounds.npy";
    return isNumpyHead(headOf(file, magic.size())) ? std::optional(file) : std::nullopt;
}

bool ownsLlff(const std::string& name) { return name == "poses_bounds.npy"; }

}  // namespace

const ForeignReader llffReader{findLlff, ownsLlff, parseLlff};

}  // namespace relamp
