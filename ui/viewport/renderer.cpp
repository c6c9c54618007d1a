#include "viewport/renderer.h"

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

namespace relamp::ui {
namespace {

/// Places inside a pixel that the images of an average look through: a rank-1 lattice, the first one in the middle.
Vec2 shiftOf(int sample) {
    const float n = float(Renderer::samplesAtRest);
    const Vec2 p(std::fmod(0.5f + float(sample) / n, 1.0f), std::fmod(0.5f + float(sample) * 0.3819660f, 1.0f));
    return p - 0.5f;
}

Mat4 shifted(const EyeView& eye, int sample) {
    const Vec2 shift = 2.0f * shiftOf(sample) / Vec2(float(eye.width), float(eye.height));
    return glm::translate(Mat4(1), Vec3(shift, 0)) * eye.clipFromWorld;
}

void setMatrix(const GlProgram& program, const char* name, const Mat4& m) {
    glUniformMatrix4fv(program.uniform(name), 1, GL_FALSE, glm::value_ptr(m));
}
void setVector(const GlProgram& program, const char* name, const Vec3& v) {
    glUniform3f(program.uniform(name), v.x, v.y, v.z);
}
void setInt(const GlProgram& program, const char* name, int value) { glUniform1i(program.uniform(name), value); }

void bindTexture(int unit, GLuint texture, GLenum kind = GL_TEXTURE_2D) {
    glActiveTexture(GLenum(GL_TEXTURE0 + unit));
    glBindTexture(kind, texture);
}

GLenum kindOf(const DisplayLut& lut) {
    return lut.dimensions == 3 ? GL_TEXTURE_3D : lut.dimensions == 2 ? GL_TEXTURE_2D : GL_TEXTURE_1D;
}

}  // namespace

Renderer::Renderer()
    : mesh_("mesh.vert", "mesh.frag"),
      texturedMesh_("mesh.vert", "mesh.frag", "#define TEXTURED"),
      image_("whole.vert", "image.frag"),
      environment_("whole.vert", "environment.frag"),
      lines_("lines.vert", "lines.frag"),
      flat_("flat.vert", "flat.frag"),
      outline_("whole.vert", "outline.frag"),
      averaging_("whole.vert", "average.frag"),
      seen_("seen.vert", "seen.frag") {
    setDisplay(displayTransform().shader(displayTransform().defaultView()));
}

void Renderer::setDisplay(const DisplayShader& shader) {
    display_ = GlProgram("whole.vert", "display.frag", shader.source);
    luts_.clear();
    lutNames_ = shader.luts;
    for (DisplayLut& lut : lutNames_) {
        GlTexture texture;
        const GLenum kind = kindOf(lut), format = lut.channels == 1 ? GL_RED : GL_RGB;
        const GLint stored = lut.channels == 1 ? GL_R32F : GL_RGB32F, filter = lut.nearest ? GL_NEAREST : GL_LINEAR;
        glBindTexture(kind, texture.id());
        glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
        if (lut.dimensions == 3)
            glTexImage3D(kind, 0, stored, lut.width, lut.height, lut.depth, 0, format, GL_FLOAT, lut.values.data());
        else if (lut.dimensions == 2)
            glTexImage2D(kind, 0, stored, lut.width, lut.height, 0, format, GL_FLOAT, lut.values.data());
        else glTexImage1D(kind, 0, stored, lut.width, 0, format, GL_FLOAT, lut.values.data());
        glTexParameteri(kind, GL_TEXTURE_MIN_FILTER, filter);
        glTexParameteri(kind, GL_TEXTURE_MAG_FILTER, filter);
        for (GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
            glTexParameteri(kind, wrap, GL_CLAMP_TO_EDGE);
        lut.values.clear();
        luts_.push_back(std::move(texture));
    }
}

void Renderer::resize(int width, int height) {
    if (width != depthWidth_ || height != depthHeight_) {
        glBindTexture(GL_TEXTURE_2D, depth_.id());
        glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, width, height, 0, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT,
                     nullptr);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
        depthWidth_ = width, depthHeight_ = height;
    }
    scene_.resize(width, height, GL_RGBA16F, depth_.id(), GL_NEAREST);
    screen_.resize(width, height, GL_RGBA8, depth_.id(), GL_LINEAR);
}

void Renderer::drawWhole() {
    glBindVertexArray(none_.id());
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glBindVertexArray(0);
}

void Renderer::drawLayer(const ImageJob& job, const SceneLayer& layer, const Mat4& clipFromWorld) {
    const EyeView& eye = job.eye;
    const int left = int(std::lround(layer.left * float(eye.width))),
              right = int(std::lround(layer.right * float(eye.width)));
    if (right <= left) return;
    const ImageBox whole{left, 0, right - left, eye.height};
    if (!layer.instead || !layer.insteadBox) {
        drawPart(job, layer, clipFromWorld, whole);
        return;
    }
    SceneLayer around = layer;
    around.instead = 0;
    drawPart(job, around, clipFromWorld, whole);
    ImageBox inside = *layer.insteadBox;
    const int end = std::min(inside.left + inside.width, right);
    inside.left = std::max(inside.left, left);
    inside.width = end - inside.left;
    if (inside.width <= 0) return;
    glEnable(GL_SCISSOR_TEST);
    glScissor(inside.left, eye.height - inside.top - inside.height, inside.width, inside.height);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    drawPart(job, layer, clipFromWorld, inside);
}

void Renderer::drawPart(const ImageJob& job, const SceneLayer& layer, const Mat4& clipFromWorld, const ImageBox& box) {
    const EyeView& eye = job.eye;
    glEnable(GL_SCISSOR_TEST);
    glScissor(box.left, eye.height - box.top - box.height, box.width, box.height);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    if (const EnvironmentLayer& environment = layer.environment; environment.latLong) {
        environment_.use();
        setMatrix(environment_, "worldFromClip", glm::inverse(eye.clipFromWorld));
        setVector(environment_, "forward", eye.forward);
        setInt(environment_, "orthographic", eye.orthographic);
        setInt(environment_, "latLong", 0);
        glUniform1f(environment_.uniform("yaw"), environment.yawDegrees * pi / 180);
        setVector(environment_, "gain", environment.gain);
        glUniform3fv(environment_.uniform("sides"), GLsizei(environment.sides.size()), &environment.sides[0].x);
        bindTexture(0, environment.latLong);
        drawWhole();
    }
    const auto drawImage = [&](GLuint texture) {
        glEnable(GL_BLEND);
        glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
        image_.use();
        setInt(image_, "image", 0);
        bindTexture(0, texture);
        drawWhole();
        glDisable(GL_BLEND);
    };
    if (layer.behind) drawImage(layer.behind);
    if (layer.instead && layer.insteadBox) {
        const ImageBox& at = *layer.insteadBox;
        glViewport(at.left, eye.height - at.top - at.height, at.width, at.height);
        drawImage(layer.instead);
        glViewport(0, 0, eye.width, eye.height);
    } else if (layer.instead) {
        drawImage(layer.instead);
    }
    if (layer.mesh && (layer.colours || layer.instead)) {
        glEnable(GL_DEPTH_TEST);
        glDepthFunc(GL_LESS);
        if (layer.instead) {
            glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
            flat_.use();
            setMatrix(flat_, "clipFromWorld", clipFromWorld);
        } else {
            GlProgram& mesh = layer.texture ? texturedMesh_ : mesh_;
            mesh.use();
            setMatrix(mesh, "clipFromWorld", clipFromWorld);
            setVector(mesh, "eye", eye.orthographic ? -eye.forward : eye.position);
            setInt(mesh, "orthographic", eye.orthographic);
            setInt(mesh, "shading", layer.shading);
            if (layer.texture) {
                setInt(mesh, "detail", 0);
                setInt(mesh, "inPlace", layer.inPlace);
                bindTexture(0, layer.texture);
            }
            glUniform1f(mesh.uniform("kind"), layer.display ? 2.0f : 1.0f);
        }
        if (layer.some) layer.mesh->drawSubset(*layer.some, 3 * layer.someTriangles, layer.colours);
        else layer.mesh->draw(layer.instead ? nullptr : layer.colours, !layer.instead && layer.texture);
        glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
        glDisable(GL_DEPTH_TEST);
    }
    glDisable(GL_SCISSOR_TEST);
}

void Renderer::drawDisplay(const ImageJob& job) {
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    display_.use();
    setInt(display_, "scene", 0);
    bindTexture(0, scene_.colour.id());
    glUniform1f(display_.uniform("exposure"), std::exp2(job.stops));
    setInt(display_, "falseColour", job.falseColour);
    if (job.falseColour) {
        float bands[13][3];
        for (int i = 0; i < 13; ++i) {
            const Rgb c = falseColour(0.18f * std::exp2(float(i + falseColourLow)));
            for (int k = 0; k < 3; ++k) bands[i][k] = c[k];
        }
        glUniform3fv(display_.uniform("bands"), 13, &bands[0][0]);
    }
    for (size_t i = 0; i < luts_.size(); ++i) {
        setInt(display_, lutNames_[i].sampler.c_str(), int(i) + 1);
        bindTexture(int(i) + 1, luts_[i].id(), kindOf(lutNames_[i]));
    }
    drawWhole();
    glActiveTexture(GL_TEXTURE0);
}

void Renderer::drawLines(const ImageJob& job, const Mat4& clipFromWorld) {
    if (!job.lines || !job.lineVertices) return;
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LEQUAL);
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    lines_.use();
    setMatrix(lines_, "clipFromWorld", clipFromWorld);
    glBindVertexArray(lineArray_.id());
    glBindBuffer(GL_ARRAY_BUFFER, job.lines->id());
    glEnableVertexAttribArray(0);
    glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(LineVertex), nullptr);
    glEnableVertexAttribArray(1);
    glVertexAttribPointer(1, 4, GL_FLOAT, GL_FALSE, sizeof(LineVertex),
                          reinterpret_cast<const void*>(offsetof(LineVertex, colour)));
    glDrawArrays(GL_LINES, 0, GLsizei(job.lineVertices));
    glBindVertexArray(0);
    glDepthMask(GL_TRUE);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
}

void Renderer::drawWires(const ImageJob& job, const Mat4& clipFromWorld) {
    if (!job.wires) return;
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LEQUAL);
    flat_.use();
    setMatrix(flat_, "clipFromWorld", clipFromWorld);
    // First the surfaces' depth alone, where nothing has drawn it, so that edges behind are hidden.
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(1, 1);
    job.wires->draw(nullptr);
    glDisable(GL_POLYGON_OFFSET_FILL);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    glUniform4f(flat_.uniform("colour"), 0.35f, 0.85f, 1.0f, job.wireStrength);
    glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    job.wires->draw(nullptr);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    glDepthMask(GL_TRUE);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
}

void Renderer::drawOutline(const ImageJob& job, const Mat4& clipFromWorld) {
    if (!job.outlined || !job.outlineIndices || !job.outlineCount) return;
    mask_.resize(job.eye.width, job.eye.height, GL_R8, 0, GL_NEAREST);
    glBindFramebuffer(GL_FRAMEBUFFER, mask_.framebuffer.id());
    glClearColor(0, 0, 0, 0);
    glClear(GL_COLOR_BUFFER_BIT);
    flat_.use();
    setMatrix(flat_, "clipFromWorld", clipFromWorld);
    glUniform4f(flat_.uniform("colour"), 1, 1, 1, 1);
    job.outlined->drawSubset(*job.outlineIndices, job.outlineCount);
    glBindFramebuffer(GL_FRAMEBUFFER, screen_.framebuffer.id());
    glEnable(GL_SCISSOR_TEST);
    glScissor(job.outlineBox[0], job.outlineBox[1], job.outlineBox[2], job.outlineBox[3]);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    outline_.use();
    setInt(outline_, "mask", 0);
    setInt(outline_, "radius", job.outlineRadius);
    const Rgb& line = job.outlineColour;
    glUniform4f(outline_.uniform("colour"), line.r, line.g, line.b, 0.95f);
    bindTexture(0, mask_.colour.id());
    drawWhole();
    glDisable(GL_BLEND);
    glDisable(GL_SCISSOR_TEST);
}

void Renderer::addToAverage(float fraction) {
    average_.resize(screen_.width, screen_.height, GL_RGBA16F, 0, GL_LINEAR);
    glBindFramebuffer(GL_FRAMEBUFFER, average_.framebuffer.id());
    glViewport(0, 0, average_.width, average_.height);
    averaging_.use();
    setInt(averaging_, "image", 0);
    bindTexture(0, screen_.colour.id());
    glEnable(GL_BLEND);
    glBlendColor(0, 0, 0, fraction);
    glBlendFunc(GL_CONSTANT_ALPHA, GL_ONE_MINUS_CONSTANT_ALPHA);
    drawWhole();
    glDisable(GL_BLEND);
}

void Renderer::draw(const ImageJob& job, int sample) {
    const int width = job.eye.width, height = job.eye.height;
    if (sample == 1) addToAverage(1);  // what the screen shows is the first image of the average
    resize(width, height);
    const Mat4 clipFromWorld = shifted(job.eye, sample);
    glViewport(0, 0, width, height);
    glBindFramebuffer(GL_FRAMEBUFFER, scene_.framebuffer.id());
    glClearColor(0, 0, 0, 0);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glDisable(GL_CULL_FACE);
    for (const SceneLayer& layer : job.layers) drawLayer(job, layer, clipFromWorld);
    glBindFramebuffer(GL_FRAMEBUFFER, screen_.framebuffer.id());
    drawDisplay(job);
    drawLines(job, clipFromWorld);
    drawWires(job, clipFromWorld);
    drawOutline(job, clipFromWorld);
    averaged_ = sample > 0;
    if (averaged_) addToAverage(1 / float(sample + 1));
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glUseProgram(0);
}

std::vector<uint8_t> Renderer::seenTriangles(const EyeView& eye, GpuMesh& mesh, GlBuffer& indices, size_t triangles) {
    resize(eye.width, eye.height);
    numbers_.resize(eye.width, eye.height, GL_RGBA8, depth_.id(), GL_NEAREST);
    glBindFramebuffer(GL_FRAMEBUFFER, numbers_.framebuffer.id());
    glViewport(0, 0, eye.width, eye.height);
    glClearColor(0, 0, 0, 0);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glDisable(GL_CULL_FACE);
    glDisable(GL_BLEND);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    seen_.use();
    setMatrix(seen_, "clipFromWorld", shifted(eye, 0));
    mesh.drawSubset(indices, 3 * triangles);
    glDisable(GL_DEPTH_TEST);
    std::vector<uint8_t> pixels(size_t(eye.width) * size_t(eye.height) * 4), seen(triangles, 0);
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glReadPixels(0, 0, eye.width, eye.height, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    for (size_t i = 0; i < pixels.size(); i += 4) {
        const size_t number = size_t(pixels[i]) + 256 * size_t(pixels[i + 1]) + 65536 * size_t(pixels[i + 2]);
        if (number > 0 && number <= triangles) seen[number - 1] = 1;
    }
    return seen;
}

std::vector<uint8_t> Renderer::readBack(int& width, int& height) {
    GlTarget& target = averaged_ ? average_ : screen_;
    width = target.width, height = target.height;
    const size_t row = size_t(width) * 4, bytes = row * size_t(height);
    std::vector<uint8_t> pixels(bytes), covered(bytes), turned(bytes);
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    const auto read = [&](GlTarget& from, std::vector<uint8_t>& to) {
        glBindFramebuffer(GL_FRAMEBUFFER, from.framebuffer.id());
        glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, to.data());
    };
    read(target, pixels);
    read(scene_, covered);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    for (size_t i = 3; i < bytes; i += 4) pixels[i] = covered[i];
    for (size_t y = 0; y < size_t(height); ++y)
        std::copy_n(pixels.begin() + ptrdiff_t((size_t(height) - 1 - y) * row), row,
                    turned.begin() + ptrdiff_t(y * row));
    return turned;
}

}  // namespace relamp::ui
