#include "scene/texcoords.h"

#include <algorithm>

namespace relamp {
namespace {

Triangle inOrder(Triangle corners) {
    std::sort(corners.begin(), corners.end());
    return corners;
}

}  // namespace

std::vector<FaceTexcoords> texcoordsOf(const std::vector<TexturedFace>& faces, const std::vector<Triangle>& triangles) {
    struct Entry {
        Triangle corners;
        uint32_t face;
        bool operator<(const Entry& other) const {
            return std::tie(corners, face) < std::tie(other.corners, other.face);
        }
    };
    std::vector<Entry> entries;
    entries.reserve(faces.size());
    for (uint32_t f = 0; f < faces.size(); ++f) entries.push_back({inOrder(faces[f].corners), f});
    std::sort(entries.begin(), entries.end());
    std::vector<FaceTexcoords> result(triangles.size(), FaceTexcoords{});
    for (size_t t = 0; t < triangles.size(); ++t) {
        const Triangle corners = inOrder(triangles[t]);
        const auto found = std::lower_bound(entries.begin(), entries.end(), Entry{corners, 0});
        if (found == entries.end() || found->corners != corners) continue;
        const TexturedFace& face = faces[found->face];
        for (size_t k = 0; k < 3; ++k)
            for (size_t i = 0; i < 3; ++i)
                if (face.corners[i] == triangles[t][k]) result[t][k] = face.texcoords[i];
    }
    return result;
}

}  // namespace relamp
