#include "support/shapes.h"

namespace relamp::test {

std::vector<uint32_t> append(Mesh& mesh, const Mesh& part) {
    const uint32_t first = uint32_t(mesh.positions.size());
    std::vector<uint32_t> triangles;
    mesh.positions.insert(mesh.positions.end(), part.positions.begin(), part.positions.end());
    mesh.normals.insert(mesh.normals.end(), part.normals.begin(), part.normals.end());
    for (const Triangle& t : part.triangles) {
        triangles.push_back(uint32_t(mesh.triangles.size()));
        mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
    return triangles;
}

Mesh sheet(const Vec3& corner, const Vec3& edgeU, const Vec3& edgeV, int nu, int nv) {
    Mesh mesh;
    const Vec3 normal = glm::normalize(glm::cross(edgeU, edgeV));
    for (int v = 0; v <= nv; ++v)
        for (int u = 0; u <= nu; ++u) {
            mesh.positions.push_back(corner + edgeU * (float(u) / float(nu)) + edgeV * (float(v) / float(nv)));
            mesh.normals.push_back(normal);
        }
    for (int v = 0; v < nv; ++v)
        for (int u = 0; u < nu; ++u) {
            const uint32_t a = uint32_t(v * (nu + 1) + u), b = a + 1, c = a + uint32_t(nu) + 1, d = c + 1;
            mesh.triangles.push_back({a, b, d});
            mesh.triangles.push_back({a, d, c});
        }
    return mesh;
}

Mesh squareAbove(float side, float x, float y, float z, int cuts) {
    return sheet({x - side / 2, y - side / 2, z}, {0, side, 0}, {side, 0, 0}, cuts, cuts);
}

Mesh discAbove(float radius, float z, int sides) {
    Mesh mesh;
    mesh.positions.push_back({0, 0, z});
    for (int i = 0; i < sides; ++i) {
        const double a = 2 * piD * i / sides;
        mesh.positions.push_back({float(radius * std::cos(a)), float(radius * std::sin(a)), z});
    }
    mesh.normals.assign(mesh.positions.size(), Vec3(0, 0, -1));
    for (int i = 0; i < sides; ++i) mesh.triangles.push_back({0u, uint32_t(1 + (i + 1) % sides), uint32_t(1 + i)});
    return mesh;
}

Mesh ball(const Vec3& centre, float radius, int rings, int around) {
    Mesh mesh;
    const auto add = [&](const Vec3& n) {
        mesh.positions.push_back(centre + radius * n);
        mesh.normals.push_back(n);
    };
    add({0, 0, 1});
    for (int r = 1; r < rings; ++r)
        for (int i = 0; i < around; ++i) {
            const float t = pi * float(r) / float(rings), p = 2 * pi * float(i) / float(around);
            add({std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)});
        }
    add({0, 0, -1});
    const auto at = [&](int r, int i) {
        return r == 0       ? 0u
               : r == rings ? uint32_t(mesh.positions.size() - 1)
                            : uint32_t(1 + (r - 1) * around + i % around);
    };
    for (int r = 0; r < rings; ++r)
        for (int i = 0; i < around; ++i) {
            if (r > 0) mesh.triangles.push_back({at(r, i), at(r + 1, i), at(r, i + 1)});
            if (r + 1 < rings) mesh.triangles.push_back({at(r, i + 1), at(r + 1, i), at(r + 1, i + 1)});
        }
    return mesh;
}

Mesh box(const Vec3& low, const Vec3& high, int cuts) {
    Mesh mesh;
    const Vec3 d = high - low, x(d.x, 0, 0), y(0, d.y, 0), z(0, 0, d.z);
    append(mesh, sheet(low, y, x, cuts, cuts));
    append(mesh, sheet(low + z, x, y, cuts, cuts));
    append(mesh, sheet(low, x, z, cuts, cuts));
    append(mesh, sheet(low + y, z, x, cuts, cuts));
    append(mesh, sheet(low, z, y, cuts, cuts));
    append(mesh, sheet(low + x, y, z, cuts, cuts));
    return mesh;
}

Scene sceneOf(const Mesh& mesh) {
    Progress progress;
    return buildScene(mesh, progress);
}

EmitterClusters emittersOf(const Scene& scene, const std::vector<std::vector<uint32_t>>& triangles,
                           const std::vector<Rgb>& radiance) {
    EmitterClusters clusters;
    for (size_t i = 0; i < triangles.size(); ++i) {
        EmitterCluster cluster;
        cluster.triangles = triangles[i];
        std::vector<uint8_t> mine(scene.mesh.vertexCount(), 0);
        for (uint32_t t : triangles[i]) {
            for (uint32_t v : scene.mesh.triangles[t]) mine[v] = 1;
            cluster.area += scene.mesh.triangleArea(t);
            cluster.normal += scene.mesh.faceNormal(t) * scene.mesh.triangleArea(t);
            for (uint32_t v : scene.mesh.triangles[t])
                cluster.centroid += scene.mesh.positions[v] * (scene.mesh.triangleArea(t) / 3);
        }
        cluster.centroid /= cluster.area;
        cluster.normal = glm::length(cluster.normal) > 0.1f * cluster.area ? glm::normalize(cluster.normal) : Vec3(0);
        for (uint32_t v = 0; v < mine.size(); ++v)
            if (mine[v]) cluster.vertices.push_back(v);
        cluster.radiance = radiance[i];
        clusters.emitters.push_back(cluster);
    }
    indexEmitters(scene, clusters);
    return clusters;
}

double rayTriangle(const DVec3& origin, const DVec3& direction, const DVec3& a, const DVec3& b, const DVec3& c) {
    const DVec3 e1 = b - a, e2 = c - a, p = glm::cross(direction, e2);
    const double det = glm::dot(e1, p);
    if (det == 0) return std::numeric_limits<double>::infinity();
    const DVec3 s = origin - a, q = glm::cross(s, e1);
    const double u = glm::dot(s, p) / det, v = glm::dot(direction, q) / det, t = glm::dot(e2, q) / det;
    return u >= 0 && v >= 0 && u + v <= 1 && t > 0 ? t : std::numeric_limits<double>::infinity();
}

bool blockedByBruteForce(const Mesh& mesh, const Vec3& origin, const Vec3& direction, double far) {
    for (const Triangle& t : mesh.triangles)
        if (rayTriangle(DVec3(origin), DVec3(direction), DVec3(mesh.positions[t[0]]), DVec3(mesh.positions[t[1]]),
                        DVec3(mesh.positions[t[2]])) < far)
            return true;
    return false;
}

double cornerFormFactor(double a, double b, double c) {
    const double x = a / c, y = b / c, rx = std::sqrt(1 + x * x), ry = std::sqrt(1 + y * y);
    return (x / rx * std::atan(y / rx) + y / ry * std::atan(x / ry)) / (2 * piD);
}

double centredSquareFormFactor(double side, double height) { return 4 * cornerFormFactor(side / 2, side / 2, height); }

double rectangleFormFactor(double x0, double x1, double y0, double y1, double c) {
    const auto corner = [&](double x, double y) {
        return std::copysign(1.0, x * y) * cornerFormFactor(std::abs(x), std::abs(y), c);
    };
    return corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0);
}

double uprightFormFactor(double a, double b, double c) {
    const double x = a / b, y = c / b, r = std::sqrt(x * x + y * y);
    return (std::atan(1 / y) - y / r * std::atan(1 / r)) / (2 * piD);
}

}  // namespace relamp::test
