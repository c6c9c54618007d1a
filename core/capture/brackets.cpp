#include "capture/brackets.h"

#include <numeric>

#include "base/error.h"
#include "base/parallel.h"
#include "capture/bracket_codes.h"
#include "image/image_io.h"

namespace relamp {

/// The exposure most pixels of which are neither bright nor dark.
size_t bestExposed(const std::vector<CodeImage>& images, const std::vector<size_t>& order) {
    const size_t pixels = images[0].codes.size() / 3;
    size_t best = order[0], most = 0;
    for (const size_t i : order) {
        size_t well = 0;
        for (size_t p = 0; p < pixels; p += std::max<size_t>(1, pixels / 50000)) {
            const uint16_t* z = &images[i].codes[p * 3];
            well += std::max({z[0], z[1], z[2]}) < 230 * 257 && std::min({z[0], z[1], z[2]}) > 25 * 257;
        }
        if (well > most) {
            most = well;
            best = i;
        }
    }
    return best;
}

std::vector<size_t> fromShortest(const std::vector<double>& exposures) {
    std::vector<size_t> order(exposures.size());
    std::iota(order.begin(), order.end(), size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return exposures[a] < exposures[b]; });
    return order;
}

namespace {

struct ReadSet {
    std::vector<CodeImage> images;
    std::vector<double> exposures;
    std::vector<PixelShift> shifts;  // empty: none was moved
};

ReadSet readSet(const Bracket& set, const BracketOptions& options, const Progress& progress) {
    ReadSet read;
    read.images.resize(set.size());
    parallelFor(set.size(), 1, [&](size_t i) {
        read.images[i] = readCodes(set[i].file, options.maxPixels, [&] { progress.check(); });
    });
    for (size_t i = 0; i < set.size(); ++i) {
        const CodeImage &p = read.images[i], &first = read.images[0];
        if (p.width != first.width || p.height != first.height)
            throw Error("{}: is {} x {} pixels, {} is {} x {}", set[i].file.string(), p.width, p.height,
                        set[0].file.string(), first.width, first.height);
        read.exposures.push_back(set[i].exposure);
    }
    if (!options.align || set.size() < 2) return read;
    size_t reference = bestExposed(read.images, fromShortest(read.exposures));
    for (size_t i = 0; i < set.size(); ++i)
        if (set[i].reference) reference = i;
    read.shifts = bracketShifts(read.images, read.exposures, reference);
    if (std::all_of(read.shifts.begin(), read.shifts.end(), [](const PixelShift& s) { return s == PixelShift{}; }))
        read.shifts.clear();
    for (size_t i = 0; i < read.shifts.size(); ++i) read.images[i] = shifted(read.images[i], read.shifts[i]);
    return read;
}

}  // namespace

ResponseCurve responseOf(const std::vector<Bracket>& sets, const BracketOptions& options, Progress& progress) {
    progress.begin("Response curve", sets.size());
    std::vector<ResponseSample> samples;
    const size_t each = std::max<size_t>(200, options.samples / std::max<size_t>(1, sets.size()));
    // Beyond this many sets, every so many are enough.
    const size_t stride = std::max<size_t>(1, sets.size() * each / (2 * options.samples));
    size_t linear = 0, looked = 0;
    for (size_t i = 0; i < sets.size(); ++i) {
        progress.advance();
        if (i % stride != 0 || sets[i].empty()) continue;
        const ReadSet read = readSet(sets[i], options, progress);
        for (const CodeImage& p : read.images) linear += p.linear, ++looked;
        for (ResponseSample& s : sampleBracket(read.images, read.exposures, each)) samples.push_back(std::move(s));
    }
    if (linear && linear != looked)
        throw Error("{}: some exposures are linear (camera raw) and others are not", sets[0][0].file.string());
    if (linear) return linearResponse();
    return withContext(sets.empty() || sets[0].empty() ? std::string("brackets") : sets[0][0].file.string(),
                       [&] { return fitResponse(samples, options.smoothness); });
}

MergedBracket mergeBracket(const Bracket& set, const ResponseCurve& response, const BracketOptions& options,
                           Progress& progress) {
    const ReadSet read = readSet(set, options, progress);
    return mergeCodes(read.images, read.exposures, response, options, progress, read.shifts);
}

BracketPhoto bracketPhoto(const std::filesystem::path& file, ExposureTags tags, ExposureReference& reference) {
    if (!(tags.seconds > 0)) throw Error("{}: its exposure time is not given, and its EXIF has none", file.string());
    if (!reference.known) reference = {tags.aperture, tags.iso, true};
    double gain = 1;
    // Light through the lens goes with 1 / aperture^2, the signal with the sensitivity. Where one photograph says
    // nothing it is taken to be as the first.
    if (tags.aperture > 0 && reference.aperture > 0)
        gain *= (reference.aperture / tags.aperture) * (reference.aperture / tags.aperture);
    if (tags.iso > 0 && reference.iso > 0) gain *= tags.iso / reference.iso;
    return {file, tags.seconds * gain};
}

}  // namespace relamp
