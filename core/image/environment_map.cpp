#include "image/environment_map.h"

#include <limits>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "image/image_io.h"

namespace relamp {
namespace {

/// Texel by column and row; wraps in longitude, stays at the poles.
const Rgb& wrapped(const Image& image, int x, int y) {
    x %= image.width;
    if (x < 0) x += image.width;
    return image.at(x, std::clamp(y, 0, image.height - 1));
}

/// Solid angle of a texel of row y: d phi x (sin of the upper edge - sin of the lower edge).
double texelSolidAngle(const Image& image, int y) {
    const double top = piD * (0.5 - double(y) / image.height), bottom = piD * (0.5 - double(y + 1) / image.height);
    return 2 * piD / image.width * (std::sin(top) - std::sin(bottom));
}

}  // namespace

Vec2 latLongFromDirection(const Vec3& direction) {
    const float z = std::clamp(direction.z / glm::length(direction), -1.0f, 1.0f);
    const float u = 0.5f - std::atan2(direction.y, direction.x) / (2 * pi);
    return {u, 0.5f - std::asin(z) / pi};
}

Vec3 directionFromLatLong(const Vec2& uv) {
    const float azimuth = (0.5f - uv.x) * 2 * pi, elevation = (0.5f - uv.y) * pi;
    return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation)};
}

Image readEnvironment(const std::filesystem::path& file) {
    Image image = readImage(file);
    if (std::abs(double(image.width) / image.height - 2) > 0.02)
        throw Error("{}: is {} x {} pixels, expected a latitude-longitude image twice as wide as high", file.string(),
                    image.width, image.height);
    image.usable.clear();  // alpha says nothing about a surrounding; what was not finite is 0 by now
    return image;
}

Rgb environmentRadiance(const Image& latLong, const Vec3& direction) {
    const Vec2 uv = latLongFromDirection(direction);
    const float x = uv.x * float(latLong.width) - 0.5f, y = uv.y * float(latLong.height) - 0.5f;
    const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
    const float fx = x - float(x0), fy = y - float(y0);
    const Rgb top = wrapped(latLong, x0, y0) * (1 - fx) + wrapped(latLong, x0 + 1, y0) * fx;
    const Rgb bottom = wrapped(latLong, x0, y0 + 1) * (1 - fx) + wrapped(latLong, x0 + 1, y0 + 1) * fx;
    return top * (1 - fy) + bottom * fy;
}

namespace {

/// The cells of a grid under the components of a latitude-longitude image. Components of a column share their azimuth,
/// so one arc tangent serves them all. Where rounding could decide, DirectionGrid::cellOf does: the cell is always its.
class ComponentCells {
public:
    /// `columns` = components of a row.
    ComponentCells(const DirectionGrid& grid, size_t columns) : grid_(grid), upright_(grid.axes == Mat3(1)) {
        columns_.reserve(columns);
        for (size_t i = 0; i < columns; ++i) {
            const double azimuth = (0.5 - (double(i) + 0.5) / double(columns)) * 2 * piD;
            const double cosine = std::cos(azimuth), sine = std::sin(azimuth);
            columns_.push_back({cosine, sine, std::atan2(std::abs(sine), std::abs(cosine)) * (2 / piD),
                                std::copysign(0.5, cosine), std::copysign(0.5, sine), columns});
        }
        for (size_t i = columns; i-- > 1;) {
            Column &before = columns_[i - 1], &after = columns_[i];
            const bool one = before.halfSignX == after.halfSignX && before.halfSignY == after.halfSignY;
            before.end = one ? after.end : i;
        }
    }
    /// Calls body(first column, one past the last, cell) for the components at height z, in order of the columns.
    template <class Body>
    void forRow(double z, Body&& body) const {
        const double r = std::sqrt(std::max(0.0, 1 - z * z));
        // sphereToSquare in double precision, but for the radius, which is its own.
        const double radius = double(std::sqrt(std::max(0.0f, 1 - std::abs(float(z))))), side = grid_.side;
        const double doubt = upright_ ? 2e-6 * side : 1;  // its single precision is good to 3e-7
        // Within a quadrant both coordinates change by as much from one column to the next: x with the sign of the
        // sine, y against that of the cosine.
        const double perColumn = std::max(2 * side * radius / double(columns_.size()), 1e-12);
        for (size_t i = 0; i < columns_.size();) {
            const Column& c = columns_[i];
            double v = c.azimuth * radius, u = radius - v;
            if (z < 0) u = 1 - std::exchange(v, 1 - u);
            const double x = (u * c.halfSignX + 0.5) * side, y = (v * c.halfSignY + 0.5) * side;
            const int column = int(x), row = int(y);
            const double inX = x - column, inY = y - row;
            size_t end = i + 1;
            if (std::min(inX, inY) > doubt && std::max(inX, inY) < 1 - doubt) {
                const double left = std::min(c.halfSignY > 0 ? 1 - inX : inX, c.halfSignX > 0 ? inY : 1 - inY) - doubt;
                end = std::min(c.end, end + size_t(left / perColumn));
                body(i, end, size_t(row * grid_.side + column));
            } else {
                body(i, end, size_t(grid_.cellOf(Vec3(float(r * c.cosine), float(r * c.sine), float(z)))));
            }
            i = end;
        }
    }

private:
    struct Column {
        double cosine, sine;
        double azimuth;               ///< within its quadrant, 0 to 1
        double halfSignX, halfSignY;  ///< of the quadrant
        size_t end;                   ///< one past the last column of the quadrant
    };
    DirectionGrid grid_;
    bool upright_;
    std::vector<Column> columns_;
};

}  // namespace

std::vector<Rgb> integrateOverCells(const Image& latLong, const DirectionGrid& grid) {
    // A texel is split into components much smaller than a cell, at least 4 x 4. Components of a row have equal solid
    // angle, so every texel gives away exactly its energy. The components that land in a cell do not add up to exactly
    // its solid angle; the difference is taken to be of the cell's darkest radiance, so that a constant map stays
    // constant in every cell while a bright spot keeps its energy.
    const double cellEdge = std::sqrt(4 * piD / grid.cells()), texelEdge = piD / latLong.height;
    const int split = std::clamp(int(std::ceil(16 * texelEdge / cellEdge)), 4, 256);
    struct Sum {
        std::vector<DVec3> energy;
        std::vector<double> angle;
        std::vector<Rgb> darkest;
        Sum& operator+=(const Sum& other) {
            if (energy.empty()) return *this = other;
            if (other.energy.empty()) return *this;
            for (size_t i = 0; i < energy.size(); ++i) {
                energy[i] += other.energy[i];
                angle[i] += other.angle[i];
                darkest[i] = glm::min(darkest[i], other.darkest[i]);
            }
            return *this;
        }
    };
    const ComponentCells cells(grid, size_t(latLong.width) * size_t(split));
    const size_t rowsAtOnce = std::max<size_t>(1, (size_t(latLong.height) + 31) / 32);
    const Sum sum = parallelSum(size_t(latLong.height), rowsAtOnce, Sum{}, [&](size_t begin, size_t end) {
        Sum part;
        part.energy.assign(size_t(grid.cells()), DVec3(0));
        part.angle.assign(size_t(grid.cells()), 0.0);
        part.darkest.assign(size_t(grid.cells()), Rgb(std::numeric_limits<float>::infinity()));
        for (size_t y = begin; y < end; ++y) {
            const double component = texelSolidAngle(latLong, int(y)) / (double(split) * split);
            const double zTop = std::sin(piD * (0.5 - double(y) / latLong.height));
            const double zBottom = std::sin(piD * (0.5 - double(y + 1) / latLong.height));
            for (int s = 0; s < split; ++s) {
                const double z = zTop + (zBottom - zTop) * (s + 0.5) / split;  // equal area: even steps in z
                cells.forRow(z, [&](size_t first, size_t last, size_t cell) {
                    for (size_t i = first, next; i < last; i = next) {
                        const size_t texel = i / size_t(split);
                        next = std::min(last, (texel + 1) * size_t(split));
                        const Rgb& radiance = latLong.at(int(texel), int(y));
                        part.energy[cell] += DVec3(radiance) * (component * double(next - i));
                        part.darkest[cell] = glm::min(part.darkest[cell], radiance);
                    }
                    part.angle[cell] += component * double(last - first);
                });
            }
        }
        return part;
    });
    std::vector<Rgb> radiance(size_t(grid.cells()));
    const double cellAngle = 4 * piD / grid.cells();
    for (size_t i = 0; i < radiance.size(); ++i)
        if (sum.angle[i] > 0)
            radiance[i] = Rgb((sum.energy[i] - DVec3(sum.darkest[i]) * (sum.angle[i] - cellAngle)) / cellAngle);
    return radiance;
}

namespace {

/// Which cell of the square of directions lies under a point of a latitude-longitude image whose texels are cut into
/// split x split parts. Azimuth and height are those of a column and a row of parts, so no angle is computed twice
/// (sphereToSquare).
class LatLongRaster {
public:
    LatLongRaster(const DirectionGrid& grid, int width, int height, int split)
        : side_(grid.side), columns_(size_t(width * split)), rows_(size_t(height * split)) {
        for (size_t i = 0; i < columns_.size(); ++i) {
            const Vec3 d = directionFromLatLong(Vec2((float(i) + 0.5f) / float(columns_.size()), 0.5f));
            columns_[i] = {std::atan2(std::abs(d.y), std::abs(d.x)) * (2 / pi), d.x, d.y};
        }
        for (size_t i = 0; i < rows_.size(); ++i) {
            const float z = directionFromLatLong(Vec2(0.5f, (float(i) + 0.5f) / float(rows_.size()))).z;
            rows_[i] = {std::sqrt(std::max(0.0f, 1 - std::abs(z))), z < 0};
        }
    }
    size_t cell(int column, int row) const {
        const Column& c = columns_[size_t(column)];
        const Row& r = rows_[size_t(row)];
        float v = c.azimuth * r.radius, u = r.radius - v;
        if (r.below) {
            const float swap = u;
            u = 1 - v;
            v = 1 - swap;
        }
        const auto at = [&](float t, float sign) {
            return std::clamp(int((std::copysign(t, sign) * 0.5f + 0.5f) * float(side_)), 0, side_ - 1);
        };
        return size_t(at(v, c.y)) * size_t(side_) + size_t(at(u, c.x));
    }

private:
    struct Column {
        float azimuth, x, y;
    };
    struct Row {
        float radius;
        bool below;
    };
    int side_;
    std::vector<Column> columns_;
    std::vector<Row> rows_;
};

}  // namespace

Image latLongFromCells(const std::vector<Rgb>& cells, const DirectionGrid& grid, int width) {
    Image image(width, width / 2);
    std::vector<Rgb> darkest(image.pixels.size()), brightest(image.pixels.size());
    const LatLongRaster coarse(grid, width, image.height, 2), fine(grid, width, image.height, 16);
    const auto mean = [&](const LatLongRaster& raster, int x, int y, int split, Rgb& low, Rgb& high) {
        DVec3 sum(0);
        low = Rgb(std::numeric_limits<float>::infinity());
        high = Rgb(0);
        for (int sy = 0; sy < split; ++sy)
            for (int sx = 0; sx < split; ++sx) {
                const Rgb& value = cells[raster.cell(x * split + sx, y * split + sy)];
                sum += DVec3(value);
                low = glm::min(low, value);
                high = glm::max(high, value);
            }
        return Rgb(sum / double(split * split));
    };
    parallelFor(image.pixels.size(), 4096, [&](size_t i) {
        image.pixels[i] = mean(coarse, int(i) % width, int(i) / width, 2, darkest[i], brightest[i]);
    });
    // The rim of a sun is cut finely, so that it keeps its energy; neighbours count, because two by two observations
    // miss a corner.
    parallelFor(image.pixels.size(), 4096, [&](size_t i) {
        const int x = int(i) % width, y = int(i) / width;
        Rgb low = darkest[i], high = brightest[i];
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx) {
                const size_t k =
                    size_t(std::clamp(y + dy, 0, image.height - 1)) * size_t(width) + size_t((x + dx + width) % width);
                low = glm::min(low, darkest[k]);
                high = glm::max(high, brightest[k]);
            }
        if (maxChannel(high - 2.0f * low) > 0) image.pixels[i] = mean(fine, x, y, 16, low, high);
    });
    return image;
}

Image yawed(const Image& latLong, float degrees) {
    // Turning the world counter-clockwise moves what stood at +X towards +Y, which lies to the left of the centre.
    Image image(latLong.width, latLong.height);
    double shift = std::fmod(double(degrees) / 360 * latLong.width, double(latLong.width));
    if (!std::isfinite(shift)) shift = 0;
    const double whole = std::floor(shift);
    const float part = float(shift - whole);
    const int columns = int(whole);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            image.at(x, y) = wrapped(latLong, x + columns, y) * (1 - part);
            if (part > 0) image.at(x, y) += wrapped(latLong, x + columns + 1, y) * part;
        }
    return image;
}

}  // namespace relamp
