#include "wavelet/affine_products.h"

#include <bit>

#include "base/error.h"
#include "wavelet/haar.h"

namespace relamp {
namespace {

using Node = HaarTree::Node;
using DVec2 = glm::dvec2;

double cross(const DVec2& a, const DVec2& b) { return a.x * b.y - a.y * b.x; }

std::vector<float> cellsOf(const SparseCoefs& coefs, int side) {
    std::vector<float> cells(size_t(side) * size_t(side), 0.0f);
    scatter(coefs, cells);
    haarInverse(cells, side);
    for (float& c : cells) c *= float(side);  // over the root of a cell's area
    return cells;
}

/// An interval in each of two directions.
struct Box {
    DVec2 low{0}, high{0};
    bool meets(const Box& o) const {
        return low.x < o.high.x && o.low.x < high.x && low.y < o.high.y && o.low.y < high.y;
    }
    bool holds(const Box& o) const {
        return low.x <= o.low.x && low.y <= o.low.y && high.x >= o.high.x && high.y >= o.high.y;
    }
};

Box squareOf(const Node& n) {
    const DVec2 low(double(n.i) * n.size(), double(n.j) * n.size());
    return {low, low + n.size()};
}

AffineMap within(const AffineMap& map, const Node& n) {
    const Box b = squareOf(n);
    return {map.origin + b.low.x * map.alongX + b.low.y * map.alongY, n.size() * map.alongX, n.size() * map.alongY};
}

/// The smallest box about the image of a box.
Box imageOf(const AffineMap& map, const Box& b) {
    const DVec2 middle = 0.5 * (b.low + b.high), half = 0.5 * (b.high - b.low);
    const DVec2 centre = map.origin + middle.x * map.alongX + middle.y * map.alongY,
                reach = half.x * glm::abs(map.alongX) + half.y * glm::abs(map.alongY);
    return {centre - reach, centre + reach};
}

AffineMap inverseOf(const AffineMap& m, double determinant) {
    const DVec2 x = DVec2(m.alongY.y, -m.alongX.y) / determinant, y = DVec2(-m.alongY.x, m.alongX.x) / determinant;
    return {-(m.origin.x * x + m.origin.y * y), x, y};
}

/// One function as the still side of a walk.
struct One {
    const HaarTree& a;
    bool constant(const Node& n) const { return a.constant(n); }
    bool meanKnown(const Node&) const { return true; }
    double mean(const Node& n) const { return double(a.mean(n)); }
};

/// The product of two: its mean over a square is known where one of them is constant.
struct Two {
    const HaarTree &a, &b;
    bool zero(const HaarTree& f, const Node& n) const { return f.constant(n) && f.mean(n) == 0; }
    bool constant(const Node& n) const { return (a.constant(n) && b.constant(n)) || zero(a, n) || zero(b, n); }
    bool meanKnown(const Node& n) const { return a.constant(n) || b.constant(n); }
    double mean(const Node& n) const { return double(a.mean(n)) * double(b.mean(n)); }
};

template <class Still>
class Walk {
public:
    Walk(const Still& still, const HaarTree& moved, const AffineMap& map, double determinant)
        : still_(still), moved_(moved), map_(map), back_(inverseOf(map, determinant)), scale_(std::abs(determinant)) {}
    double pair(const Node& s, const Node& m) const {
        const bool evenStill = still_.constant(s), evenMoved = moved_.constant(m);
        if ((evenStill && still_.mean(s) == 0) || (evenMoved && moved_.mean(m) == 0)) return 0;
        // Two parallelograms are apart exactly when they are in one of their two frames.
        const Box square = squareOf(s), source = squareOf(m), image = imageOf(map_, source),
                  preimage = imageOf(back_, square);
        if (!square.meets(image) || !source.meets(preimage)) return 0;
        if (evenMoved && source.holds(preimage) && still_.meanKnown(s))
            return still_.mean(s) * double(moved_.mean(m)) * s.size() * s.size();
        if (evenStill && square.holds(image))
            return still_.mean(s) * double(moved_.mean(m)) * scale_ * m.size() * m.size();
        if (evenStill && evenMoved)
            return still_.mean(s) * double(moved_.mean(m)) * sharedArea(within(map_, m), square.low, s.size());
        const bool openStill = !evenStill && (evenMoved || s.size() * s.size() >= scale_ * m.size() * m.size());
        double sum = 0;
        for (int k = 0; k < 4; ++k) sum += openStill ? pair(s.child(k), m) : pair(s, m.child(k));
        return sum;
    }

private:
    const Still& still_;
    const HaarTree& moved_;
    AffineMap map_, back_;
    double scale_;
};

template <class Still>
double product(const Still& still, const HaarTree& moved, const AffineMap& map) {
    const double determinant = cross(map.alongX, map.alongY);
    if (!std::isfinite(determinant) || !std::isfinite(map.origin.x) || !std::isfinite(map.origin.y))
        throw Error("affine product: the map is not finite");
    if (std::abs(determinant) < 1e-300) return 0;
    return Walk<Still>(still, moved, map, determinant).pair({}, {});
}

}  // namespace

HaarTree::HaarTree(std::span<const float> cells, int side) {
    if (side < 1 || !std::has_single_bit(unsigned(side)))
        throw Error("Haar tree: side is {}, expected a power of two", side);
    if (cells.size() != size_t(side) * size_t(side))
        throw Error("Haar tree: {} values, expected {} x {}", cells.size(), side, side);
    const int depth = std::countr_zero(unsigned(side));
    mean_.resize(at({depth + 1, 0, 0}));
    constant_.assign(mean_.size(), 1);
    std::copy(cells.begin(), cells.end(), mean_.begin() + ptrdiff_t(at({depth, 0, 0})));
    for (int level = depth - 1; level >= 0; --level)
        for (int j = 0; j < 1 << level; ++j)
            for (int i = 0; i < 1 << level; ++i) {
                const Node n{level, i, j};
                float sum = 0;
                bool even = true;
                for (int k = 0; k < 4; ++k) {
                    const Node c = n.child(k);
                    sum += mean(c);
                    even = even && constant(c) && mean(c) == mean(n.child(0));
                }
                mean_[at(n)] = even ? mean(n.child(0)) : sum / 4;
                constant_[at(n)] = even;
            }
}

HaarTree::HaarTree(const SparseCoefs& coefs, int side) : HaarTree(cellsOf(coefs, side), side) {}

double sharedArea(const AffineMap& map, const DVec2& low, double size) {
    const DVec2 high = low + size;
    if ((map.alongX.y == 0 && map.alongY.x == 0) || (map.alongX.x == 0 && map.alongY.y == 0)) {
        const DVec2 far = map.origin + map.alongX + map.alongY;
        const DVec2 extent = glm::min(glm::max(map.origin, far), high) - glm::max(glm::min(map.origin, far), low);
        return extent.x > 0 && extent.y > 0 ? extent.x * extent.y : 0;
    }
    DVec2 polygon[20] = {map.origin, map.origin + map.alongX, map.origin + map.alongX + map.alongY,
                         map.origin + map.alongY},
          clipped[20];
    int count = 4;
    for (int side = 0; side < 4 && count; ++side) {
        const int axis = side / 2;
        const double sign = side % 2 ? -1 : 1, border = side % 2 ? high[axis] : low[axis];
        int kept = 0;
        for (int k = 0; k < count; ++k) {
            const DVec2 &a = polygon[k], &b = polygon[(k + 1) % count];
            const double da = sign * (a[axis] - border), db = sign * (b[axis] - border);
            if (da >= 0) clipped[kept++] = a;
            if ((da > 0 && db < 0) || (da < 0 && db > 0)) clipped[kept++] = a + (b - a) * (da / (da - db));
        }
        std::copy(clipped, clipped + kept, polygon);
        count = kept;
    }
    double twice = 0;
    for (int k = 2; k < count; ++k) twice += cross(polygon[k - 1] - polygon[0], polygon[k] - polygon[0]);
    return std::abs(twice) / 2;
}

double affineDoubleProduct(const HaarTree& still, const HaarTree& moved, const AffineMap& map) {
    return product(One{still}, moved, map);
}

double affineTripleProduct(const HaarTree& a, const HaarTree& b, const HaarTree& moved, const AffineMap& map) {
    return product(Two{a, b}, moved, map);
}

std::optional<AffineMap> planarEmitterMap(const Vec3& point, const Vec3& towards, const Vec3& axisX, const Vec3& corner,
                                          const Vec3& edgeU, const Vec3& edgeV, float reach) {
    const DVec3 z(towards), x(axisX), y = glm::cross(z, x), to = DVec3(corner) - DVec3(point);
    const double distance = glm::dot(to, z);
    if (!(distance > 0)) return {};
    const double scale = 1 / (2 * double(reach) * distance);
    const auto onPlane = [&](const DVec3& v) { return scale * DVec2(glm::dot(v, x), glm::dot(v, y)); };
    return AffineMap{onPlane(to) + 0.5, onPlane(DVec3(edgeU)), onPlane(DVec3(edgeV))};
}

}  // namespace relamp
