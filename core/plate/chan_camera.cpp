// Nuke's channel files: a line a frame.
#include <glm/gtc/matrix_transform.hpp>

#include "base/atomic_file.h"
#include "base/text_scanner.h"
#include "plate/plate_camera.h"
#include "shot/frame_numbers.h"

namespace relamp {
namespace {

constexpr size_t maxChanBytes = size_t(256) << 20, maxLines = 1'000'000;

bool isOrder(std::string order) {
    std::sort(order.begin(), order.end());
    return order == "XYZ";
}

DMat4 rotation(const std::string& order, const DVec3& degrees) {
    DMat4 turn(1.0);
    for (char axis : order) {
        DVec3 about(0);
        about[axis - 'X'] = 1;
        turn = glm::rotate(DMat4(1.0), glm::radians(degrees[axis - 'X']), about) * turn;
    }
    return turn;
}

}  // namespace

CameraTrack readChan(const std::filesystem::path& file, const std::string& rotationOrder) {
    if (!isOrder(rotationOrder))
        throw BadOption("--plate-rotation {}: expected an order of X, Y and Z, such as ZXY", rotationOrder);
    const std::string text = readBytes(file, maxChanBytes);
    CameraTrack track;
    TextScanner lines(text);
    for (size_t line = 1; !lines.atEnd(); ++line) {
        if (line > maxLines) throw Error("{}: has more than {} lines", file.string(), maxLines);
        std::string_view content = lines.line();
        content = content.substr(0, content.find('#'));
        TextScanner words(content);
        std::vector<double> numbers;
        for (std::string_view word = words.word(); !word.empty(); word = words.word()) {
            const auto number = TextScanner::number(word);
            if (!number || !std::isfinite(*number) || std::abs(*number) > 1e12)
                throw Error("{}: line {}: '{}' is no number", file.string(), line, std::string(word.substr(0, 40)));
            numbers.push_back(*number);
            if (numbers.size() > 64) break;
        }
        if (numbers.empty()) continue;
        if (numbers.size() < 7)
            throw Error("{}: line {}: has {} numbers, expected frame, position, rotation and field of view",
                        file.string(), line, numbers.size());
        if (numbers[0] != std::floor(numbers[0]) || std::abs(numbers[0]) > 1e9)
            throw Error("{}: line {}: {} is no frame number", file.string(), line, numbers[0]);
        TrackedCamera camera;
        camera.worldFromCamera = rotation(rotationOrder, {numbers[4], numbers[5], numbers[6]});
        camera.worldFromCamera[3] = glm::dvec4(numbers[1], numbers[2], numbers[3], 1);
        if (numbers.size() > 7) {
            if (!(numbers[7] > 0 && numbers[7] < 179))
                throw Error("{}: line {}: the vertical field of view is {}, expected 0 to 179 degrees", file.string(),
                            line, numbers[7]);
            camera.halfHeight = std::tan(glm::radians(numbers[7]) / 2);
        }
        if (!track.byFrame.emplace(int(numbers[0]), camera).second)
            throw Error("{}: line {}: frame {} is there twice", file.string(), line, int(numbers[0]));
    }
    if (track.byFrame.empty()) throw Error("{}: holds no frame", file.string());
    return track;
}

}  // namespace relamp
