// RealityCapture's (RealityScan's) "Internal/External camera parameters": comma-separated, one row a photograph.
//
// The help of RealityCapture and its article "XMP camera math" give the lens: Brown's, k1 to k4 and t1, t2 in OpenCV's
// order, with f in millimetres on 36 mm of the longer side. px and py are the principal point's distance from the
// middle as a fraction of the longer side (published exports hold 0.001 to 0.02, which is tens of pixels, as usual;
// taken as millimetres it would be less than one). x, y, alt are the position, Z up. The rotation is
// worldFromCamera = Rz(-heading) Rx(pitch) Ry(roll), degrees, with OpenGL's camera axes, as the importers of Nerfstudio
// and Brush have it: pitch 0 looks straight down, pitch 90 and heading 0 look along +y.
#include <algorithm>

#include "base/atomic_file.h"
#include "base/text_scanner.h"
#include "capture/formats/readers.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

constexpr const char* columns[] = {"name", "x",  "y",  "alt", "heading", "pitch", "roll", "f",
                                   "px",   "py", "k1", "k2",  "k3",      "k4",    "t1",   "t2"};
constexpr size_t neededColumns = 8;

std::vector<std::string_view> cells(std::string_view line) {
    std::vector<std::string_view> found;
    for (;;) {
        const size_t comma = line.find(',');
        std::string_view cell = line.substr(0, comma);
        while (!cell.empty() && (TextScanner::isSpace(cell.front()) || cell.front() == '"')) cell.remove_prefix(1);
        while (!cell.empty() && (TextScanner::isSpace(cell.back()) || cell.back() == '"')) cell.remove_suffix(1);
        found.push_back(cell);
        if (comma == line.npos) return found;
        line.remove_prefix(comma + 1);
    }
}

/// Where each of `columns` stands in the file; npos: nowhere.
using Places = std::vector<size_t>;

std::optional<Places> placesFrom(std::string_view header) {
    if (header.starts_with("\xef\xbb\xbf")) header.remove_prefix(3);
    auto names = cells(header);
    if (!names.empty() && names[0].starts_with('#')) names[0].remove_prefix(1);
    Places places;
    for (size_t i = 0; i < std::size(columns); ++i) {
        const auto at = std::find(names.begin(), names.end(), columns[i]);
        if (at == names.end() && i < neededColumns) return std::nullopt;
        places.push_back(at == names.end() ? std::string::npos : size_t(at - names.begin()));
    }
    return places;
}

/// The header: the first line, or the second where a line "#cameras 12" stands before it.
std::optional<Places> headerOf(TextScanner& scanner) {
    for (int i = 0; i < 2 && !scanner.atEnd(); ++i)
        if (const auto places = placesFrom(scanner.line())) return places;
    return std::nullopt;
}

bool isRealityCaptureHead(std::string_view head) {
    TextScanner scanner(head);
    return headerOf(scanner).has_value();
}

ForeignView viewFrom(const std::vector<std::string_view>& row, const Places& places, const ForeignFolder& around) {
    const auto cell = [&](size_t column) {
        const size_t at = places[column];
        return at < row.size() ? row[at] : std::string_view();
    };
    const std::string name(cell(0));
    if (name.empty()) throw Error("name is missing");
    return withContext(name.substr(0, 200), [&] {
        double v[std::size(columns)] = {};
        for (size_t i = 1; i < std::size(columns); ++i)
            if (i < neededColumns || !cell(i).empty()) v[i] = numberFrom(cell(i), columns[i]);
        ForeignView view{name, {}};
        Camera& camera = view.camera;
        const auto [width, height] = around.sizeOf(name);
        setSize(camera, width, height);
        const double longer = std::max(width, height);
        camera.focalX = camera.focalY = v[7] * longer / 36;
        camera.centreX = 0.5 * width + v[8] * longer;
        camera.centreY = 0.5 * height + v[9] * longer;
        setLens(camera, {v[10], v[11], v[12], v[13], v[14], v[15]});
        checkIntrinsics(camera, {"f (in pixels)", "f (in pixels)", "px (in pixels)", "py (in pixels)"});
        const auto sine = [](double degrees) { return std::sin(degrees * piD / 180); };
        const auto cosine = [](double degrees) { return std::cos(degrees * piD / 180); };
        const double ch = cosine(v[4]), sh = -sine(v[4]), cp = cosine(v[5]), sp = sine(v[5]), cr = cosine(v[6]),
                     sr = sine(v[6]);
        // By columns: first column, second, third.
        const glm::dmat3 heading(ch, sh, 0, -sh, ch, 0, 0, 0, 1), pitch(1, 0, 0, 0, cp, sp, 0, -sp, cp),
            roll(cr, 0, -sr, 0, 1, 0, sr, 0, cr);
        camera.worldFromCamera = poseFromOpenGl(heading * pitch * roll, {v[1], v[2], v[3]}, "heading, pitch, roll");
        return view;
    });
}

ForeignCameras parseRealityCapture(const fs::path& file, const ForeignFolder& around, Progress& progress) {
    const std::string text = readBytes(file, foreignFileBytes);
    TextScanner scanner(text);
    const auto places = headerOf(scanner);
    if (!places) throw Error("the header lacks one of name, x, y, alt, heading, pitch, roll, f");
    ForeignCameras result;
    result.up = Vec3(0, 0, 1);
    while (!scanner.atEnd()) {
        progress.check();
        const std::string_view line = scanner.line();
        if (line.find_first_not_of(" \t") == line.npos) continue;
        if (result.views.size() == foreignViews) throw Error("has more than {} rows", foreignViews);
        result.views.push_back(viewFrom(cells(line), *places, around));
    }
    return result;
}

std::optional<fs::path> findRealityCapture(const fs::path& folder) {
    constexpr const char* names[] = {"cameras.csv"};
    return findByHead(folder, names, ".csv", isRealityCaptureHead);
}

bool ownsRealityCapture(const std::string& name) { return name.ends_with(".csv"); }

}  // namespace

const ForeignReader realityCaptureReader{findRealityCapture, ownsRealityCapture, parseRealityCapture};

}  // namespace relamp
