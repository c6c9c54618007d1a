// Where to look for an emitter's light from one surface point: its parts in proportion to their form factor, the finer
// the nearer they are.
#pragma once
#include "transport/near_field.h"

namespace relamp {

/// Draws points on one emitter for a given surface point. The emitter is cut into at most 64 parts: groups of
/// neighbouring triangles where it is far or turned away, parts of one triangle where it is near. A part is drawn in
/// proportion to an estimate of its form factor, and cut further while that estimate is coarse and its share is large.
/// A panel a centimetre off a wall then lights the wall without noise.
class EmitterSampler {
public:
    explicit EmitterSampler(const EmitterSurface& surface);

    /// One part of the cut tree.
    struct Part {
        static constexpr uint32_t none = 0xffffffffu;
        uint32_t node = none;           ///< of the emitter's tree; none: part of one triangle
        uint32_t triangle = none;       ///< the triangle that it is or is part of
        std::array<Vec3, 3> corners{};  ///< of a part of a triangle
        float area = 0;
        float weight = 0;       ///< root of estimate times bound of pi times its form factor
        float error = 0;        ///< bound less estimate
        uint32_t child = none;  ///< the first of two, next to each other
        float cumulative = 0;   ///< of a leaf: weights of leaves up to this one
    };
    /// The cut for the surface points of a small cell of space and of normals.
    struct Proposal {
        Vec3 point{0}, normal{2};  ///< the middle of the cell; not a unit vector: no cut yet
        std::vector<Part> parts;
        std::vector<uint32_t> leaves;  ///< neighbours stay together
        std::vector<uint32_t> heap;
        float total = 0;
    };
    /// Cuts that were made, found again by their cell.
    class Cuts {
    public:
        /// `atMost`: how many are kept, 8 KiB each; a power of two.
        explicit Cuts(size_t atMost = 16) : slots_(atMost) {}

    private:
        friend class EmitterSampler;
        std::vector<Proposal> slots_;
    };
    /// The cut for a surface point: of the cell around it that is a twenty-fifth of its distance to the emitter wide at
    /// most, and of normals within a degree. It depends on the point alone, whatever `cuts` holds, and is good until
    /// the next call. Null: no light can arrive. Costs about 5 microseconds where it is not among the cuts.
    const Proposal* prepare(const Vec3& point, const Vec3& normal, Cuts& cuts) const;
    /// A point on the emitter; `areaDensity` per square metre; its triangle (index into the surface).
    Vec3 sample(const Proposal& proposal, const Vec2& u, float& areaDensity, size_t& triangle) const;
    /// Density per square metre of drawing the given point of the given triangle.
    float areaDensity(const Proposal& proposal, size_t triangle, const Vec3& point) const;

private:
    /// Triangles order_[begin, end).
    struct Node {
        Mat3 frame{1};                 // z: the axis; normals lie within a cone about it
        Vec3 centre{0}, extent{0};     // of the box in that frame that holds the triangles: its middle, half its sides
        float area = 0, coneSine = 0;  // coneSine 2: any normal
        uint32_t begin = 0, end = 0, child = Part::none;
    };
    const EmitterSurface& surface_;
    std::vector<Node> nodes_;
    std::vector<uint32_t> order_, placeOf_;
    std::vector<double> areaBelow_;  // of the triangles before a place in order_

    void cutFor(const Vec3& point, const Vec3& normal, Proposal& proposal) const;
    uint32_t middleOf(uint32_t begin, uint32_t end);
    Node nodeOf(uint32_t begin, uint32_t end) const;
    void estimate(const Proposal& proposal, Part& part) const;
    void cut(const Part& part, Part& first, Part& second) const;
};

}  // namespace relamp
