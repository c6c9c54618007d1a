// What leaves an emitter, by direction and place: the one function that frames and the viewport ask for emitted
// radiance.
#pragma once
#include <array>
#include <memory>

#include "base/math.h"
#include "capture/emission_lobe.h"
#include "clusters/emission_pattern.h"
#include "relight/light_shaping.h"
#include "relight/shaping_files.h"

namespace relamp {

/// A LightShaping with its files read, in the world of one light.
class ShapedEmission {
public:
    /// `matrix`, `size`: of the added emitter; `flat`: it has a front alone. Cost: files are read once and kept while
    /// they stay as they are. Throws Error naming a file that cannot be read.
    ShapedEmission(const LightShaping& shaping, const Mat4& matrix, const Vec2& size, bool flat);
    /// A recovered emitter that shines unevenly over its surface (null: evenly) or by direction, moved by `matrix`.
    /// `flat`: it has a front alone.
    ShapedEmission(std::shared_ptr<const EmissionPattern> pattern, const Mat4& matrix, const EmissionLobe& lobe = {},
                   bool flat = false);

    /// Radiance from `point` into the unit direction `away`, in parts of the light's level.
    Rgb factor(const Vec3& away, const Vec3& point) const;
    /// What is painted on its surface at `point`, seen along `away`: an image by its mean.
    Rgb shown(const Vec3& away, const Vec3& point) const {
        if (doors_ && !pastDoors(away * toWorld_, fromMiddle(point))) return Rgb(0);
        return patternAt(point) * byDirection(away * toWorld_) * (surface_ ? surface_->mean : Rgb(1));
    }
    bool even() const { return !pattern_; }
    /// Of a recovered emitter that shines unevenly: radiance at `point` in parts of its level.
    float patternAt(const Vec3& point) const {
        return pattern_ ? pattern_->at(Vec3(toSurface_ * Vec4(point, 1))) : 1.0f;
    }
    /// Power in parts of what the light sends without shaping. Cost: 4096 directions. A disk's barn doors are counted
    /// as those of the square about it.
    Rgb mean() const;
    /// The unit direction it shines along.
    Vec3 axis() const { return -Vec3(toWorld_[2]); }
    /// Unit columns: its own axes in the world; it shines along the last one's opposite.
    const Mat3& axes() const { return toWorld_; }
    const Vec3& middle() const { return middle_; }  ///< of a flat light
    const Vec2& half() const { return half_; }      ///< half its sides, metres
    /// What the coordinates of its surface image (u to the right, v up, 0.5 in the middle) gain a metre.
    std::array<Vec3, 2> imageSlopes() const {
        const Mat3 rows = glm::transpose(Mat3(toSurface_));
        return {-rows[0] / size_.x, rows[1] / size_.y};
    }
    const LightShaping& shaping() const { return shaping_; }

private:
    LightShaping shaping_;
    Mat3 toWorld_{1};    // unit columns: the light's own axes
    Mat4 toSurface_{1};  // world to the shape, or the captured emitter, before its matrix
    Vec2 size_{1};
    bool flat_ = false;
    float innerDegrees_ = 180, gobo_ = 1;  // where the cone begins to fade; 1 / tangent of its edge
    std::shared_ptr<const IesProfile> ies_;
    std::shared_ptr<const ShapingImage> goboImage_, surface_;
    std::shared_ptr<const EmissionPattern> pattern_;

    bool doors_ = false;
    Vec3 middle_{0};  // of a flat light, and half its sides
    Vec2 half_{0};

    Rgb byDirection(const Vec3& local) const;
    /// Whether light from `point`, in the light's own axes about its middle, passes all barn doors.
    bool pastDoors(const Vec3& local, const Vec2& point) const;
    Vec2 fromMiddle(const Vec3& point) const { return Vec2((point - middle_) * toWorld_); }
};

struct EmissionProfile {
    Rgb level{0};                                    ///< radiance where the profile is 1, after power scale; 0 when off
    std::shared_ptr<const ShapedEmission> shaped{};  ///< null: Lambertian and even
    /// Radiance from `point` of the surface, scene units, into the unit direction `away` from it.
    Rgb radiance(const Vec3& away, const Vec3& point) const {
        return shaped ? level * shaped->factor(away, point) : level;
    }
    /// What the viewport paints on the light itself at `point`, seen along `away`.
    Rgb shown(const Vec3& away, const Vec3& point) const { return shaped ? level * shaped->shown(away, point) : level; }
    bool dark() const { return !(maxChannel(level) > 0); }
};

}  // namespace relamp
