#include "relight/live/environment.h"

#include "base/parallel.h"
#include "relight/backdrop.h"
#include "transport/transport_store.h"

namespace relamp {

LiveLight liveLight(const DistantLight& distant, int side) {
    LiveLight light;
    const DirectionGrid grid{side};
    light.cells.assign(size_t(grid.cells()), Rgb(0));
    const int fine = distant.grid().side;
    if (fine <= side) {
        for (int c = 0; c < grid.cells(); ++c)
            light.cells[size_t(c)] =
                distant.cells()[size_t((c / side) * fine / side * fine + (c % side) * fine / side)];
    } else {
        const int cut = fine / side;
        for (int y = 0; y < fine; ++y)
            for (int x = 0; x < fine; ++x)
                light.cells[size_t(y / cut * side + x / cut)] += distant.cells()[size_t(y * fine + x)];
        for (Rgb& c : light.cells) c /= float(cut * cut);
    }
    std::vector<float> channel(light.cells.size());
    for (int k = 0; k < 3; ++k) {
        for (size_t c = 0; c < channel.size(); ++c) channel[c] = light.cells[c][k];
        light.coefs[size_t(k)] = environmentHaar(channel, side);
    }
    return light;
}

std::shared_ptr<const DistantLight> turned(const DistantLight& distant, float degrees) {
    const DirectionGrid grid = distant.grid();
    const std::vector<Rgb>& cells = distant.cells();
    const float angle = degrees * pi / 180, cosine = std::cos(angle), sine = std::sin(angle);
    const auto turn = [&](const Vec3& d, float s) { return Vec3(cosine * d.x - s * d.y, s * d.x + cosine * d.y, d.z); };
    DVec3 sum(0);
    for (const Rgb& c : cells) sum += DVec3(c);
    const Rgb limit(sum * (8.0 / double(cells.size())));
    std::vector<Rgb> out(cells.size());
    parallelFor(cells.size(), 2048, [&](size_t c) {
        Rgb mean(0);
        for (int q = 0; q < 4; ++q) {
            const Vec3 d = turn(grid.direction(int(c), Vec2(q % 2 ? 0.75f : 0.25f, q / 2 ? 0.75f : 0.25f)), -sine);
            mean += 0.25f * glm::min(cells[size_t(grid.cellOf(d))], limit);
        }
        out[c] = mean;
    });
    constexpr int points = 16;
    for (size_t c = 0; c < cells.size(); ++c) {
        const Rgb bright = glm::max(cells[c] - limit, Rgb(0));
        if (!(maxChannel(bright) > 0)) continue;
        for (int i = 0; i < points * points; ++i) {
            const Vec2 inside((float(i % points) + 0.5f) / points, (float(i / points) + 0.5f) / points);
            out[size_t(grid.cellOf(turn(grid.direction(int(c), inside), sine)))] += bright / float(points * points);
        }
    }
    return std::make_shared<const DistantLight>(grid, std::move(out), turned(distant.backdrop(), degrees));
}

}  // namespace relamp
