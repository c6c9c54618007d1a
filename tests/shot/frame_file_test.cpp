// Frames read back with OpenImageIO, as other programs read them.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <bit>

#include "shot/cryptomatte.h"
#include "shot/export_frame.h"
#include "support/estimates.h"
#include "support/exr_header.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

/// Every channel of every part by name.
struct ReadBack {
    OIIO::ImageSpec spec;
    std::vector<std::string> parts;
    std::map<std::string, std::vector<float>> channels;
    explicit ReadBack(const std::filesystem::path& file) {
        auto in = OIIO::ImageInput::open(file.string());
        if (!in) throw std::runtime_error(OIIO::geterror());
        spec = in->spec();
        for (int part = 0; in->seek_subimage(part, 0); ++part) {
            const OIIO::ImageSpec at = in->spec();
            parts.push_back(at.get_string_attribute("oiio:subimagename").empty()
                                ? ""
                                : std::string(at.get_string_attribute("oiio:subimagename")));
            std::vector<float> pixels(size_t(at.width) * size_t(at.height) * size_t(at.nchannels));
            EXPECT_TRUE(in->read_image(part, 0, 0, at.nchannels, OIIO::TypeDesc(OIIO::TypeDesc::FLOAT), pixels.data()));
            for (int c = 0; c < at.nchannels; ++c) {
                auto& values = channels[at.channelnames[size_t(c)]];
                for (size_t i = size_t(c); i < pixels.size(); i += size_t(at.nchannels)) values.push_back(pixels[i]);
            }
        }
    }
    const std::vector<float>& operator[](const std::string& name) const { return channels.at(name); }
};

/// A matte floor under an emitter in a grey world, seen from above; the emitter is recovered and may be moved.
class FrameFile : public testing::Test {
protected:
    void SetUp() override {
        scene = test::sceneOf(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 2, 2));
        const Estimate estimate = test::matteEstimate(scene, Rgb(0.5f, 0.4f, 0.3f), Rgb(1));
        Look emitter;
        emitter.added.push_back({EmitterShape::disk, "emitter-1", test::translation({0, 0, 1}), Vec2(0.5f), Rgb(10)});
        captured = test::relitOf(scene, estimate, emitter);
        emitter.added[0].radiance = Rgb(30, 10, 5);
        look = test::relitOf(scene, estimate, emitter);
        camera = test::cameraAt({0, -2, 1.5}, {0, 0, 0.4}, 40, 33, 30);
        photograph = Image(40, 33);
        Progress progress;
        options.samplesPerPixel = 2;
        frame = renderFrame(captured, camera, options, progress);
        photograph.pixels = frame.beauty;
        for (size_t p = 0; p < photograph.pixels.size(); ++p)
            photograph.pixels[p] *= p % 2 ? 1.25f : 0.75f;  // detail no mesh has
    }
    FrameSources sources() { return {&look, &captured, &photograph, 0}; }
    ReadBack write(const FrameFileOptions& how, FrameSources from) {
        Progress progress;
        EXPECT_LT(writeFrameFile(folder / "f.exr", camera, from, options, how, progress), 1e-6);
        return ReadBack(folder / "f.exr");
    }
    FrameFileOptions with(const std::string& layers) {
        FrameFileOptions how;
        how.layers = layers;
        return how;
    }
    test::TemporaryFolder folder;
    Scene scene;
    RelitScene captured, look;
    Camera camera;
    FrameOptions options;
    Frame frame;
    Image photograph;
};

constexpr float halfRounding = 1.0f / 1024;

TEST_F(FrameFile, GroupsAndRestAreTheBeautyAsRead) {
    const ReadBack file = write(with("all"), sources());
    for (const char* c : {"R", "G", "B"})
        for (size_t p = 0; p < frame.beauty.size(); ++p) {
            const float sum = file[std::string("Combined_world.") + c][p] +
                              file[std::string("Combined_emitter_1.") + c][p] +
                              file[std::string("Combined_rest.") + c][p];
            ASSERT_NEAR(sum, file[c][p], 1.5f * halfRounding * file[c][p] + 1e-6f);
        }
}

TEST_F(FrameFile, ResidualAndCorrectionAreOfTheCapturedLight) {
    const ReadBack file = write(with("residual,correction"), sources());
    size_t lit = 0;
    for (size_t p = 0; p < frame.beauty.size(); ++p) {
        const float expected = photograph.pixels[p].x - frame.beauty[p].x;
        ASSERT_NEAR(file["residual.R"][p], expected, halfRounding * std::abs(expected) + 1e-6f);
        const bool surface = frame.alpha[p] > 0 && frame.emittersSeen[p][0].emitter < 0;
        const float baked = surface ? std::clamp(frame.beauty[p].y / frame.world[p].y, 1.0f, 64.0f) : 1.0f;
        ASSERT_NEAR(file["correction.G"][p], baked, halfRounding * baked);
        lit += baked > 1.2f;
    }
    EXPECT_GT(lit, 50u);
}

TEST_F(FrameFile, IsPackedAsAskedAndWithoutALossWhereThatIsPromised) {
    FrameFileOptions how = with("groups,depth");
    const ReadBack zip = write(how, sources());
    EXPECT_EQ(test::readExrHeader(folder / "f.exr").compression, "zip");
    for (const char* compression : exrCompressions)
        for (const bool floats : {false, true}) {
            how.exr = {compression, floats};
            how.multipart = floats;
            const ReadBack file = write(how, sources());
            const test::ExrHeader header = test::readExrHeader(folder / "f.exr");
            EXPECT_EQ(header.compression, compression);
            EXPECT_EQ(header.channels.at("R"), floats ? "float" : "half");
            for (size_t p = 0; p < frame.beauty.size(); ++p) {
                if (isLossless(how.exr) && !floats) { ASSERT_EQ(file["G"][p], zip["G"][p]) << compression; }
                ASSERT_NEAR(file["G"][p], zip["G"][p], 0.05f * zip["G"][p] + 0.01f) << compression;
            }
        }
    EXPECT_EQ(exrFormat("piz", "float", "all"), (ExrFormat{"piz", true}));
    EXPECT_THROW(exrFormat("gzip", "half", ""), BadOption);
    EXPECT_THROW(exrFormat("zip", "double", ""), BadOption);
    EXPECT_THROW(exrFormat("dwaa", "half", "groups,cryptomatte"), BadOption) << "its numbers would change";
}

TEST_F(FrameFile, ConfidenceIsThatOfTheSurfaceAndOneOnEmitters) {
    for (size_t v = 0; v < look.confidence.size(); ++v) look.confidence[v] = look.scene.mesh.positions[v].x < 0 ? 0 : 1;
    const ReadBack file = write(with("confidence"), sources());
    size_t between = 0;
    for (size_t p = 0; p < frame.beauty.size(); ++p) {
        const float expected = frame.depth[p] > 1e29f                      ? 0
                               : frame.emittersSeen[p][0].fraction > 0.99f ? 1
                               : frame.position[p].z > 0.5f                ? file["confidence.Y"][p]
                                                            : std::clamp(frame.position[p].x, -1.0f, 0.0f) + 1;
        ASSERT_NEAR(file["confidence.Y"][p], expected, 2e-3f) << p;
        between += expected > 0.2f && expected < 0.8f;
    }
    EXPECT_GT(between, 50u);
}

TEST_F(FrameFile, CryptomatteHoldsTheCoverageOfTheEmitter) {
    const ReadBack file = write(with("cryptomatte"), sources());
    size_t whole = 0;
    for (size_t p = 0; p < frame.beauty.size(); ++p) {
        const float fraction = frame.emittersSeen[p][0].fraction;
        ASSERT_EQ(file["CryptoEmitter00.G"][p], fraction);
        ASSERT_EQ(std::bit_cast<uint32_t>(file["CryptoEmitter00.R"][p]),
                  fraction > 0 ? std::bit_cast<uint32_t>(cryptomatteId("emitter-1")) : 0u);
        ASSERT_EQ(file["CryptoEmitter02.A"][p], 0);
        whole += fraction == 1;
    }
    EXPECT_GT(whole, 5u);
    const std::string key = fmt::format("cryptomatte/{:08x}", cryptomatteHash("CryptoEmitter")).substr(0, 19);
    EXPECT_EQ(file.spec.get_string_attribute(key + "/name"), "CryptoEmitter");
    EXPECT_NE(std::string(file.spec.get_string_attribute(key + "/manifest")).find("emitter-1"), std::string::npos);
}

TEST_F(FrameFile, HeaderHoldsTheCamera) {
    FrameFileOptions how = with("position");
    how.header = {{"relamp:shot", "0123456789abcdef"}, {"relamp:gauge", "emitter: seen"}};
    const ReadBack file = write(how, sources());
    EXPECT_EQ(file.spec.get_string_attribute("relamp:shot"), "0123456789abcdef");
    EXPECT_EQ(file.spec.get_string_attribute("relamp:gauge"), "emitter: seen");
    EXPECT_TRUE(file.spec.find_attribute("chromaticities"));
    const auto matrix = [&](const char* name) {
        const auto* attribute = file.spec.find_attribute(name);
        if (!attribute || attribute->type().basetype != OIIO::TypeDesc::FLOAT)
            throw std::runtime_error(std::string("no matrix ") + name);
        const float* m = static_cast<const float*>(attribute->data());
        Mat4 out;
        for (int i = 0; i < 16; ++i) out[i / 4][i % 4] = m[i];
        return out;
    };
    // A pixel's position goes through the matrices to the pixel it stands in.
    const size_t p = 20 * 40 + 23;
    ASSERT_GT(frame.alpha[p], 0);
    const Vec4 position(file["position.X"][p], file["position.Y"][p], file["position.Z"][p], 1);
    EXPECT_NEAR(-(matrix("worldToCamera") * position).z, frame.depth[p], 1e-4);
    const Vec4 ndc = matrix("worldToNDC") * position;
    EXPECT_NEAR((ndc.x / ndc.w + 1) / 2 * 40, 23.5, 0.01);
    EXPECT_NEAR((1 - ndc.y / ndc.w) / 2 * 33, 20.5, 0.01);
}

TEST_F(FrameFile, HasTheSameChannelsInOnePartOrMany) {
    FrameFileOptions how = with("all");
    const ReadBack one = write(how, sources());
    how.multipart = true;
    how.naming = LayerNaming::arnold;
    const ReadBack many = write(how, sources());
    EXPECT_TRUE(test::readExrHeader(folder / "f.exr").multipart);
    EXPECT_EQ(many.parts.size(), 1u + 3 + 6 + 4);
    EXPECT_EQ(many.parts[0], "rgba");
    EXPECT_EQ(many.parts[2], "RGBA_emitter_1");
    EXPECT_EQ(many.channels.size(), one.channels.size());
    EXPECT_EQ(many["RGBA_emitter_1.G"], one["Combined_emitter_1.G"]);
    EXPECT_EQ(many["CryptoEmitter00.G"], one["CryptoEmitter00.G"]);
    EXPECT_EQ(many["depth.Z"], one["depth.Z"]);
    EXPECT_EQ(folder.entries(), 1u);
}

TEST_F(FrameFile, RatioKeepsThePhotographsDetail) {
    FrameFileOptions how;
    how.ratio = Ratio::quotient;
    Progress progress;
    const Frame after = renderFrame(look, camera, options, progress);
    const ReadBack file = write(how, sources());
    size_t seen = 0;
    for (size_t p = 0; p < frame.beauty.size(); ++p) {
        if (frame.emittersSeen[p][0].emitter >= 0) continue;
        const float expected = (p % 2 ? 1.25f : 0.75f) * after.beauty[p].x;
        ASSERT_NEAR(file["R"][p], expected, 0.01f * expected + 1e-3f);
        ++seen;
    }
    EXPECT_GT(seen, 500u);
    // Unchanged light gives the photograph.
    FrameSources unchanged = sources();
    unchanged.look = &captured;
    const ReadBack same = write(how, unchanged);
    for (size_t p = 0; p < frame.beauty.size(); ++p)
        ASSERT_NEAR(same["G"][p], photograph.pixels[p].y, halfRounding * photograph.pixels[p].y);
}

TEST_F(FrameFile, WithoutAPhotographHasNoResidualAndNoRatio) {
    FrameSources without = sources();
    without.photograph = nullptr;
    EXPECT_FALSE(write(with("all"), without).channels.contains("residual.R"));
    Progress progress;
    EXPECT_NE(test::messageOf([&] {
                  writeFrameFile(folder / "g.exr", camera, without, options, with("residual"), progress);
              }).find("residual"),
              std::string::npos);
    FrameFileOptions how;
    how.ratio = Ratio::difference;
    EXPECT_NE(test::messageOf([&] {
                  writeFrameFile(folder / "g.exr", camera, without, options, how, progress);
              }).find("--ratio"),
              std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(folder / "g.exr"));
}

TEST_F(FrameFile, IsNotThereWhenItsRenderingIsStopped) {
    Progress progress;
    progress.requestStop();
    for (const bool multipart : {false, true}) {
        FrameFileOptions how;
        how.multipart = multipart;
        EXPECT_THROW(writeFrameFile(folder / "f.exr", camera, sources(), options, how, progress), Cancelled);
    }
    EXPECT_THROW(writeFrameFile(folder / "f.png", camera, sources(), options, {}, progress), Cancelled);
    EXPECT_EQ(folder.entries(), 0u);
}

TEST_F(FrameFile, OfTwoEmittersWithOneNameAreTwoGroups) {
    const FrameLayers layers(layerRequest("groups"), LayerNaming::blender, {"a b", "a-b", "world"});
    std::vector<std::string> names;
    for (const ChannelPart& part : layers.parts(true)) names.push_back(part.name);
    EXPECT_EQ(names, (std::vector<std::string>{"rgba", "Combined_world", "Combined_a_b", "Combined_a_b_2",
                                               "Combined_world_2", "Combined_rest"}));
}

}  // namespace
}  // namespace relamp
