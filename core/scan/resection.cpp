#include "scan/resection.h"

#include <Eigen/Geometry>

#include "base/dense.h"
#include "base/parallel.h"
#include "base/statistics.h"

namespace relamp {
namespace {

using Projection = Eigen::Matrix<double, 3, 4>;
constexpr size_t leastPoints = 50, mostPoints = 6000;
constexpr int unknowns = 14;

Eigen::Vector4d homogeneous(const DVec3& p) { return {p.x, p.y, p.z, 1}; }

double missOf(const Projection& projection, const SeenPoint& seen) {
    const Eigen::Vector3d at = projection * homogeneous(seen.point);
    return glm::length(glm::dvec2(at.x() / at.z(), at.y() / at.z()) - seen.pixel);
}

/// Least squares of the linear equations, in units in which they are of one size.
Projection linearProjection(const std::vector<SeenPoint>& points) {
    DVec3 centre(0);
    glm::dvec2 middle(0);
    for (const SeenPoint& p : points) {
        centre += p.point / double(points.size());
        middle += p.pixel / double(points.size());
    }
    double size = 0, spread = 0;
    for (const SeenPoint& p : points) {
        size += glm::distance(p.point, centre) / double(points.size());
        spread += glm::distance(p.pixel, middle) / double(points.size());
    }
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(12, 12);
    for (const SeenPoint& p : points) {
        const Eigen::Vector4d q = homogeneous((p.point - centre) / size);
        const glm::dvec2 r = (p.pixel - middle) / spread;
        for (const int axis : {0, 1}) {
            Eigen::Vector<double, 12> row = Eigen::Vector<double, 12>::Zero();
            row.segment<4>(4 * axis) = q;
            row.segment<4>(8) = -r[axis] * q;
            normal.noalias() += row * row.transpose();
        }
    }
    const Eigen::VectorXd least = eigenOf(normal, true).vectors.col(0);
    Projection projection;
    for (int r = 0; r < 3; ++r) projection.row(r) = least.segment<4>(4 * r).transpose();
    Eigen::Matrix4d toUnits = Eigen::Matrix4d::Identity() / size;
    toUnits(3, 3) = 1;
    toUnits.block<3, 1>(0, 3) = -Eigen::Vector3d(centre.x, centre.y, centre.z) / size;
    Eigen::Matrix3d toPixels = Eigen::Matrix3d::Identity() * spread;
    toPixels(2, 2) = 1;
    toPixels(0, 2) = middle.x;
    toPixels(1, 2) = middle.y;
    return toPixels * projection * toUnits;
}

/// Smallest over largest standard deviation of the points along their principal axes.
double thicknessOf(const std::vector<SeenPoint>& points) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const SeenPoint& p : points) mean += Eigen::Vector3d(p.point.x, p.point.y, p.point.z) / double(points.size());
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const SeenPoint& p : points) {
        const Eigen::Vector3d off = Eigen::Vector3d(p.point.x, p.point.y, p.point.z) - mean;
        covariance += off * off.transpose();
    }
    const Eigen::VectorXd values = eigenOf(covariance, false).values;
    return values[2] > 0 ? std::sqrt(std::max(0.0, values[0]) / values[2]) : 0;
}

/// P = K [R t] by Gram-Schmidt on the rows, from the last; none where no camera with the points before it has this
/// projection.
std::optional<Camera> cameraOf(Projection p, const std::vector<SeenPoint>& points, int width, int height) {
    if (p.block<3, 3>(0, 0).determinant() < 0) p = -p;
    const auto row = [&](int i) { return DVec3(p(i, 0), p(i, 1), p(i, 2)); };
    const double scale = glm::length(row(2));
    const DVec3 down = row(1) / scale, right = row(0) / scale;  // K's last entry is 1
    glm::dmat3 axes;                                            // rows of R
    axes[2] = row(2) / scale;
    const DVec3 upright = down - glm::dot(down, axes[2]) * axes[2];
    axes[1] = glm::normalize(upright);
    const DVec3 level = right - glm::dot(right, axes[2]) * axes[2] - glm::dot(right, axes[1]) * axes[1];
    axes[0] = glm::normalize(level);
    const DVec3 centre =
        -(glm::inverse(glm::transpose(glm::dmat3(row(0), row(1), row(2)))) * DVec3(p(0, 3), p(1, 3), p(2, 3)));
    Camera camera;
    camera.width = width;
    camera.height = height;
    camera.focalX = glm::length(level);
    camera.focalY = glm::length(upright);
    camera.centreX = glm::dot(right, axes[2]);
    camera.centreY = glm::dot(down, axes[2]);
    camera.model = LensModel::openCv;
    for (int c = 0; c < 3; ++c) {
        const double sign = c == 0 ? 1 : -1;  // OpenCV's axes to OpenGL's
        camera.worldFromCamera[c] = glm::dvec4(sign * axes[c], 0);
    }
    camera.worldFromCamera[3] = glm::dvec4(centre, 1);
    size_t before = 0;
    for (const SeenPoint& seen : points) before += camera.depthOf(seen.point) > 0;
    const bool finite =
        std::isfinite(camera.focalX + camera.focalY + camera.centreX + camera.centreY + glm::length(centre));
    if (!finite || before * 10 < points.size() * 9) return std::nullopt;
    return camera;
}

/// The camera after a step: focal lengths by a factor, principal point, four distortions, turn and shift along its
/// axes.
Camera moved(const Camera& camera, const Eigen::Matrix<double, unknowns, 1>& step, double distance) {
    Camera out = camera;
    out.focalX *= std::exp(step[0]);
    out.focalY *= std::exp(step[1]);
    out.centreX += step[2] * camera.width;
    out.centreY += step[3] * camera.height;
    for (int i = 0; i < 4; ++i) out.distortion[size_t(i)] += step[4 + i];
    const Eigen::Vector3d turn = step.segment<3>(8);
    const double angle = turn.norm();
    const Eigen::Matrix3d r =
        angle > 0 ? Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() : Eigen::Matrix3d::Identity();
    glm::dmat3 local(0);
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < 3; ++i) local[c][i] = r(i, c);
    const glm::dmat3 axes = glm::dmat3(camera.worldFromCamera) * local;
    const DVec3 shift = glm::dmat3(camera.worldFromCamera) * DVec3(step[11], step[12], step[13]) * distance;
    for (int c = 0; c < 3; ++c) out.worldFromCamera[c] = glm::dvec4(axes[c], 0);
    out.worldFromCamera[3] = glm::dvec4(camera.position() + shift, 1);
    return out;
}

/// What the lens is held near to: the ratio of focal lengths to 1, distortion to none, the principal point loosely to
/// the middle (projectors shift theirs); residuals in standard deviations.
Eigen::Matrix<double, 7, 1> priorOf(const Camera& camera) {
    Eigen::Matrix<double, 7, 1> r;
    r << std::log(camera.focalX / camera.focalY) / 0.02, (camera.centreX / camera.width - 0.5) / 0.7,
        (camera.centreY / camera.height - 0.5) / 0.7, camera.distortion[0] / 0.2, camera.distortion[1] / 0.2,
        camera.distortion[2] / 0.005, camera.distortion[3] / 0.005;
    return r;
}

struct Fit {
    const std::vector<SeenPoint>& points;
    double sigma = 1;     ///< of a pixel's coordinate
    double distance = 1;  ///< that shifts are in units of

    glm::dvec2 missAt(const Camera& camera, size_t i) const {
        const auto at = camera.projectByFormula(points[i].point);
        return at ? (*at - points[i].pixel) / sigma : glm::dvec2(1e3);
    }
    static double huber(double length) { return length < 2 ? length * length : 4 * length - 4; }
    double cost(const Camera& camera) const {
        return priorOf(camera).squaredNorm() + parallelSum(points.size(), 512, 0.0, [&](size_t begin, size_t end) {
                   double sum = 0;
                   for (size_t i = begin; i < end; ++i) sum += huber(glm::length(missAt(camera, i)));
                   return sum;
               });
    }

    using Normal = Eigen::MatrixXd;  ///< J' J, and J' r behind it
    Normal normalAt(const Camera& camera) const {
        constexpr double small = 1e-6;
        std::vector<Camera> more, less;
        for (int k = 0; k < unknowns; ++k) {
            Eigen::Matrix<double, unknowns, 1> step = Eigen::Matrix<double, unknowns, 1>::Zero();
            step[k] = small;
            more.push_back(moved(camera, step, distance));
            less.push_back(moved(camera, -step, distance));
        }
        const Normal zero = Normal::Zero(unknowns, unknowns + 1);
        Normal sum = parallelSum(points.size(), 512, zero, [&](size_t begin, size_t end) {
            Normal part = zero;
            for (size_t i = begin; i < end; ++i) {
                const glm::dvec2 miss = missAt(camera, i);
                const double length = glm::length(miss), weight = length < 2 ? 1 : 2 / length;
                Eigen::Matrix<double, 2, unknowns + 1> row;
                for (int k = 0; k < unknowns; ++k) {
                    const glm::dvec2 slope = (missAt(more[size_t(k)], i) - missAt(less[size_t(k)], i)) / (2 * small);
                    row(0, k) = slope.x;
                    row(1, k) = slope.y;
                }
                row(0, unknowns) = miss.x;
                row(1, unknowns) = miss.y;
                part.noalias() += weight * row.leftCols<unknowns>().transpose().lazyProduct(row);
            }
            return part;
        });
        Eigen::Matrix<double, 7, unknowns + 1> prior;
        for (int k = 0; k < unknowns; ++k)
            prior.col(k) = (priorOf(more[size_t(k)]) - priorOf(less[size_t(k)])) / (2 * small);
        prior.col(unknowns) = priorOf(camera);
        sum.noalias() += prior.leftCols<unknowns>().transpose().lazyProduct(prior);
        return sum;
    }
};

/// Of a symmetric positive definite matrix.
Eigen::MatrixXd inverseOf(const Eigen::MatrixXd& m) {
    const SymmetricEigen eigen = eigenOf(m, true);
    return product(eigen.vectors * eigen.values.cwiseInverse().asDiagonal(), eigen.vectors.transpose());
}

/// Levenberg-Marquardt; returns the covariance of the last normal equations.
Eigen::MatrixXd refine(Camera& camera, const Fit& fit, Progress& progress) {
    double cost = fit.cost(camera), damping = 1e-3;
    Fit::Normal normal = fit.normalAt(camera);
    for (int round = 0; round < 40; ++round) {
        progress.check();
        Eigen::MatrixXd left = normal.leftCols(unknowns);
        left.diagonal() *= 1 + damping;
        const Eigen::VectorXd step = -product(inverseOf(left), normal.col(unknowns));
        const Camera next = moved(camera, step, fit.distance);
        const double nextCost = step.allFinite() ? fit.cost(next) : INFINITY;
        if (nextCost < cost) {
            const bool settled = cost - nextCost < 1e-9 * cost;
            camera = next;
            cost = nextCost;
            damping = std::max(1e-9, damping * 0.2);
            normal = fit.normalAt(camera);
            if (settled) break;
        } else if ((damping *= 10) > 1e8) break;
    }
    return inverseOf(normal.leftCols(unknowns));
}

std::vector<double> missesOf(const Camera& camera, const std::vector<SeenPoint>& points) {
    std::vector<double> misses;
    for (const SeenPoint& seen : points) {
        const auto at = camera.projectByFormula(seen.point);
        misses.push_back(at ? glm::distance(*at, seen.pixel) : 1e6);
    }
    return misses;
}

}  // namespace

Resection resect(const std::vector<SeenPoint>& all, int width, int height, Progress& progress) {
    Resection out;
    std::vector<SeenPoint> points;
    const size_t stride = std::max<size_t>(1, all.size() / mostPoints);
    for (size_t i = 0; i < all.size(); i += stride) points.push_back(all[i]);
    if (points.size() < leastPoints) {
        out.reason = fmt::format("{} points are too few, expected {} or more", points.size(), leastPoints);
        return out;
    }
    progress.begin("Calibrating the projector", 2);
    std::vector<SeenPoint> kept = points;
    Projection projection;
    for (int round = 0; round < 6; ++round) {
        projection = linearProjection(kept);
        std::vector<double> misses;
        for (const SeenPoint& seen : points) misses.push_back(missOf(projection, seen));
        const double most = 3 * std::max(0.05, 1.4826 * medianOf(misses));
        kept.clear();
        for (size_t i = 0; i < points.size(); ++i)
            if (misses[i] < most) kept.push_back(points[i]);
    }
    if (thicknessOf(kept) < 0.003) {
        out.reason = "the points lie in one plane, which leaves its place open";
        return out;
    }
    std::optional<Camera> camera = cameraOf(projection, kept, width, height);
    if (!camera) {
        out.reason = "no projector with the surface before it has these codes: are the patterns mirrored?";
        return out;
    }
    progress.advance();
    Fit fit{points, std::max(0.02, medianOf(missesOf(*camera, points)) / 1.1774), 1};
    DVec3 mean(0);
    for (const SeenPoint& seen : kept) mean += seen.point / double(kept.size());
    fit.distance = glm::distance(mean, camera->position());
    refine(*camera, fit, progress);
    fit.sigma = std::max(0.02, medianOf(missesOf(*camera, points)) / 1.1774);
    const auto covariance = refine(*camera, fit, progress);
    const std::vector<double> misses = missesOf(*camera, points);
    double sum = 0;
    for (double miss : misses)
        if (miss < 3 * 1.4142 * fit.sigma) {
            ++out.points;
            sum += miss * miss;
        }
    out.median = medianOf(misses);
    out.rms = std::sqrt(sum / double(std::max<size_t>(1, out.points)));
    const glm::dmat3 axes(camera->worldFromCamera);
    for (int w = 0; w < 3; ++w) {
        Eigen::Vector3d row(axes[0][w], axes[1][w], axes[2][w]);
        out.positionSigma[w] = fit.distance * std::sqrt(row.dot(covariance.block<3, 3>(11, 11) * row));
    }
    out.camera = camera;
    progress.advance();
    return out;
}

}  // namespace relamp
