#include "scene/mesh_io.h"

#include <sstream>

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text_scanner.h"
#include "scene/gltf_document.h"
#include "scene/openmesh_file.h"
#include "scene/ply_reader.h"
#include "scene/triangle_soup.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

std::string lowerExtension(const fs::path& file) {
    std::string extension = file.extension().string();
    for (char& c : extension) c = char(std::tolower(static_cast<unsigned char>(c)));
    return extension;
}

bool isOff(std::string_view bytes) {
    TextScanner scanner(bytes.substr(0, 4096));
    const std::string_view word = scanner.word('#');
    return word.size() >= 3 && word.size() <= 8 && word.substr(word.size() - 3) == "OFF";
}

bool isBinaryOff(std::string_view bytes) {
    TextScanner words(TextScanner(bytes.substr(0, 4096)).line());
    words.word();
    return words.word() == "BINARY";
}

/// OpenMesh's own format, which our readers do not know. Non-manifold faces are dropped by OpenMesh.
TriangleSoup readWithOpenMesh(std::string_view bytes, const MeshLimits& limits) {
    std::istringstream checked(openMeshEssentials(bytes));
    OpenMesh::PolyMesh_ArrayKernelT<> mesh;
    OpenMesh::IO::Options options(OpenMesh::IO::Options::Binary);
    omerr().disable();
    omlog().disable();
    bool good = false;
    try {
        good = OpenMesh::IO::read_mesh(mesh, checked, ".om", options);
    } catch (const std::exception&) { good = false; }
    if (!good) throw Error("cannot be read as a mesh");
    TriangleSoup soup;
    soup.positions.reserve(mesh.n_vertices());
    for (const auto v : mesh.vertices())
        soup.positions.emplace_back(mesh.point(v)[0], mesh.point(v)[1], mesh.point(v)[2]);
    std::vector<int64_t> corners;
    for (const auto f : mesh.faces()) {
        corners.clear();
        for (const auto v : mesh.fv_range(f)) corners.push_back(v.idx());
        soup.addFace(corners, soup.positions.size(), limits);
    }
    return soup;
}

/// Content decides where it can; endings only where it cannot.
TriangleSoup readSoup(const fs::path& file, std::string_view bytes, const MeshLimits& limits) {
    if (bytes.empty()) throw Error("is empty");
    const std::string extension = lowerExtension(file);
    if (bytes.substr(0, 3) == "ply" && bytes.size() > 3 && TextScanner::isSpace(bytes[3]))
        return readPly(bytes, file, limits);
    if (isGltf(bytes)) return readGltf(bytes, file, limits);
    if (isOff(bytes)) return isBinaryOff(bytes) ? readBinaryOff(bytes, limits) : readOff(bytes, limits);
    if (extension == ".obj") return readObj(bytes, file, limits);
    if (extension == ".stl") return readStl(bytes, limits);
    if (extension == ".ply") return readPly(bytes, file, limits);
    if (extension == ".off") return readOff(bytes, limits);
    if (extension == ".om") return readWithOpenMesh(bytes, limits);
    throw Error("is no mesh relamp reads, expected PLY, OBJ, glTF, STL, OFF or OM");
}

std::vector<TexturedFace> texturedFaces(const TriangleSoup& soup) {
    std::vector<TexturedFace> faces;
    for (size_t t = 0; t < soup.texcoords.size(); ++t)
        if (soup.texcoords[t] != FaceTexcoords{})
            faces.push_back({soup.triangles[t], soup.texcoords[t], t < soup.images.size() ? soup.images[t] : -1});
    return faces;
}

}  // namespace

Mesh readMesh(const fs::path& file, MeshReport* report, const MeshLimits& limits, std::vector<TexturedFace>* texcoords,
              MeshPaint* paint) {
    const std::string bytes = readBytes(file, mostMeshBytes);
    return withContext(file.string(), [&] {
        MeshReport found;
        TriangleSoup soup = readSoup(file, bytes, limits);
        if (texcoords) *texcoords = texturedFaces(soup);
        if (paint) *paint = std::move(soup.paint);
        Mesh mesh = repairSoup(std::move(soup), report != nullptr, found);
        if (report) *report = found;
        return mesh;
    });
}

void writeVertexPly(const fs::path& file, const Mesh& mesh, const std::vector<VertexProperty>& properties,
                    const DVec3& origin, const std::vector<FaceTexcoords>& texcoords) {
    const size_t vertices = mesh.vertexCount();
    std::string bytes = "ply\nformat binary_little_endian 1.0\n";
    bytes += fmt::format("element vertex {}\n", vertices);
    const bool far = origin != DVec3(0);
    for (const char* name : {"x", "y", "z"}) bytes += fmt::format("property {} {}\n", far ? "double" : "float", name);
    for (const char* name : {"nx", "ny", "nz"}) bytes += fmt::format("property float {}\n", name);
    for (const VertexProperty& property : properties) {
        const bool oneWord = !property.name.empty() && property.name.find_first_of(" \t\r\n") == std::string::npos;
        if (!oneWord) throw Error("{}: property \"{}\" is no name of one word", file.string(), property.name);
        if (property.values.size() != vertices)
            throw Error("{}: property {} has {} values for {} vertices", file.string(), property.name,
                        property.values.size(), vertices);
        bytes += fmt::format("property {} {}\n", property.asInt ? "int" : "float", property.name);
    }
    bytes += fmt::format("element face {}\nproperty list uchar int vertex_indices\n", mesh.triangles.size());
    if (!texcoords.empty()) bytes += "property list uchar float texcoord\n";
    bytes += "end_header\n";
    bytes.reserve(bytes.size() + vertices * (36 + 4 * properties.size()) + mesh.triangles.size() * 38);
    const auto put = [&](const auto& value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
    const std::vector<Vec3> fromFaces =
        mesh.normals.size() == vertices ? std::vector<Vec3>() : vertexNormalsFromFaces(mesh);
    const std::vector<Vec3>& normals = mesh.normals.size() == vertices ? mesh.normals : fromFaces;
    for (size_t v = 0; v < vertices; ++v) {
        if (far) put(origin + DVec3(mesh.positions[v]));
        else put(mesh.positions[v]);
        put(normals[v]);
        for (const VertexProperty& property : properties) {
            if (property.asInt) put(int32_t(std::lround(std::clamp(property.values[v], -2.1e9f, 2.1e9f))));
            else put(property.values[v]);
        }
    }
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        bytes.push_back(3);
        for (const uint32_t corner : mesh.triangles[t]) put(int32_t(corner));
        if (texcoords.empty()) continue;
        bytes.push_back(6);
        put(texcoords[t]);
    }
    writeBytesAtomically(file, bytes);
}

std::vector<VertexProperty> readVertexPly(const fs::path& file) {
    const std::string bytes = readBytes(file, mostMeshBytes);
    return withContext(file.string(), [&] {
        const PlyHeader header = readPlyHeader(bytes);
        PlyCursor cursor(bytes, header);
        for (const PlyElement& element : header.elements) {
            if (element.name != "vertex") {
                cursor.skip(element);
                continue;
            }
            if (element.count > MeshLimits().maxVertices)
                throw Error("element vertex has {} entries, expected at most {}", element.count,
                            MeshLimits().maxVertices);
            std::vector<VertexProperty> properties;
            std::vector<size_t> place(element.properties.size());
            for (size_t p = 0; p < element.properties.size(); ++p) {
                const PlyProperty& from = element.properties[p];
                place[p] = properties.size();
                if (from.isList) continue;
                properties.push_back({from.name, {}, from.type != PlyType::float32 && from.type != PlyType::float64});
                properties.back().values.resize(element.count);
            }
            std::vector<double> ignored;
            for (size_t v = 0; v < element.count; ++v)
                for (size_t p = 0; p < element.properties.size(); ++p) {
                    const PlyProperty& from = element.properties[p];
                    if (from.isList) cursor.list(from, ignored);
                    else properties[place[p]].values[v] = float(cursor.scalar(from.type));
                }
            return properties;
        }
        throw Error("has no element vertex");
    });
}

std::vector<TexturedFace> readTexturedFaces(const fs::path& file) {
    const std::string bytes = readBytes(file, mostMeshBytes);
    return withContext(file.string(), [&] {
        const PlyHeader header = readPlyHeader(bytes);
        PlyCursor cursor(bytes, header);
        std::vector<TexturedFace> faces;
        for (const PlyElement& element : header.elements) {
            const int at = element.find("texcoord"), corners = element.find("vertex_indices");
            if (element.name != "face" || at < 0 || corners < 0 || !element.properties[size_t(at)].isList ||
                !element.properties[size_t(corners)].isList) {
                cursor.skip(element);
                continue;
            }
            std::vector<double> values;
            for (size_t f = 0; f < element.count; ++f) {
                TexturedFace face{};
                size_t known = 0;
                for (size_t p = 0; p < element.properties.size(); ++p) {
                    const PlyProperty& from = element.properties[p];
                    if (!from.isList) {
                        cursor.scalar(from.type);
                        continue;
                    }
                    cursor.list(from, values);
                    if (int(p) == corners && values.size() == 3) {
                        for (size_t k = 0; k < 3; ++k) face.corners[k] = uint32_t(std::clamp(values[k], 0.0, 4e9));
                        ++known;
                    } else if (int(p) == at && values.size() == 6) {
                        for (size_t k = 0; k < 3; ++k)
                            face.texcoords[k] = Vec2(float(values[2 * k]), float(values[2 * k + 1]));
                        ++known;
                    }
                }
                if (known == 2 && face.texcoords != FaceTexcoords{}) faces.push_back(face);
            }
        }
        return faces;
    });
}

}  // namespace relamp
