// How well lobes reproduce measured reflectance: relamp's own basis, the dictionary pruned to a few lobes, and the best
// single published models, on measured materials that are not part of this repository.
//   brdf_fit FOLDER [MATERIAL.binary ...]
// FOLDER holds nbrdf_merl_67.csv, sgd_merl_67.csv, abc_merl_100.csv (formulas in their headers); a MERL file
// named after one of the networks and filled from it is compared with it: the reader's own error.
#include <algorithm>
#include <array>
#include <cstdio>

#include "bench/measured_materials.h"

namespace {
using namespace relamp;
using namespace relamp::bench;
/// Shifted gamma distribution [Bagher12].
Rgb sgd(const std::vector<double>& p, const Vec3& light, const Vec3& eye) {
    const HalfAngles a = halfAngles(light, eye);
    Rgb out;
    for (size_t c = 0; c < 3; ++c) {
        const auto at = [&](size_t group) { return p[group * 3 + c]; };
        const double u = std::cos(a.difference), f = at(4) - u * at(5) + std::pow(1 - u, 5) * (1 - at(4));
        const double tan2 = std::pow(std::tan(a.half), 2), shifted = at(2) + tan2 / at(2);
        const double d = at(6) * std::exp(-shifted) / (piD * std::pow(shifted, at(3)) * std::pow(std::cos(a.half), 4));
        const auto g = [&](double cosine) {
            const double beyond = std::max(0.0, std::acos(std::clamp(cosine, 0.0, 1.0)) - at(10));
            return std::clamp(1 + at(7) * (1 - std::exp(at(8) * std::pow(beyond, at(9)))), 0.0, 1.0);
        };
        const double li = double(light.z), le = double(eye.z);
        out[int(c)] = float(std::max(0.0, (at(0) + at(1) * f * d * g(li) * g(le) / (li * le)) / piD));
    }
    return out;
}

/// ABC microfacets [Low12].
Rgb abc(const std::vector<double>& p, const Vec3& light, const Vec3& eye) {
    const Vec3 h = glm::normalize(light + eye);
    const double hz = double(h.z), li = double(light.z), le = double(eye.z), dot = double(glm::dot(h, light));
    const double g = std::min({1.0, 2 * hz * li / dot, 2 * hz * le / dot});
    const double f = double(dielectricFresnel(float(dot), float(p[8])));
    Rgb out;
    for (size_t c = 0; c < 3; ++c)
        out[int(c)] = float(p[c] / piD + f * p[3 + c] / std::pow(1 + p[6] * (1 - hz), p[7]) * g / (piD * li * le));
    return out;
}

double quantile(std::vector<double> values, double q) {
    std::sort(values.begin(), values.end());
    return values.empty() ? 0 : values[size_t(q * double(values.size() - 1) + 0.5)];
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) return std::fprintf(stderr, "brdf_fit FOLDER [MATERIAL.binary ...]\n"), 2;
    try {
        const std::string folder = argv[1];
        const Rows networks = readTable(folder + "/nbrdf_merl_67.csv"), sgds = readTable(folder + "/sgd_merl_67.csv"),
                   abcs = readTable(folder + "/abc_merl_100.csv");
        const std::vector<BrdfSample> samples = brdfSamples();
        const std::vector<NamedLobe> own = lobesOf(builtInBasis()), dictionary = lobeDictionary();
        const char* names[] = {
            "SGD, published",     "ABC, published",     "built-in basis, 13 lobes", "the same, fitted to cube roots",
            "dictionary, best 3", "dictionary, best 5", "dictionary, best 8",       "dictionary, whole",
            "best 5, cube roots", "whole, cube roots"};
        constexpr size_t methods = std::size(names);
        std::array<std::vector<double>, methods> radiance, cube;
        std::vector<double> lobes;
        Progress progress;
        std::printf("%-28s", "relative L2 / cube root");
        for (const char* n : {"SGD", "ABC", "built-in", "best 5", "whole"}) std::printf(" %16s", n);
        std::puts("");
        for (const auto& [material, weights] : networks) {
            const BrdfFunction truth = network(weights);
            std::vector<Rgb> values, model(samples.size());
            for (const BrdfSample& s : samples) values.push_back(truth(s.towardLight, s.towardEye));
            std::array<std::pair<double, double>, methods> e{};
            const auto published = [&](const Rows& rows, auto&& function) {
                const auto row = rows.find(material);
                if (row == rows.end()) throw Error("{}: is in no table", material);
                for (size_t i = 0; i < samples.size(); ++i)
                    model[i] = function(row->second, samples[i].towardLight, samples[i].towardEye);
                return brdfErrors(samples, values, model);
            };
            e[0] = published(sgds, sgd);
            e[1] = published(abcs, abc);
            const auto fit = [&](const std::vector<NamedLobe>& basis, FitMetric metric, size_t most) {
                const BrdfFit f = projectBrdf(truth, basis, samples, metric, most, progress);
                if (most == 0 && &basis == &dictionary && metric == FitMetric::radiance)
                    lobes.push_back(double(f.lobes));
                return std::pair{f.radianceError, f.cubeRootError};
            };
            e[2] = fit(own, FitMetric::radiance, 0);
            e[3] = fit(own, FitMetric::cubeRoot, 0);
            e[4] = fit(dictionary, FitMetric::radiance, 3);
            e[5] = fit(dictionary, FitMetric::radiance, 5);
            e[6] = fit(dictionary, FitMetric::radiance, 8);
            e[7] = fit(dictionary, FitMetric::radiance, 0);
            e[8] = fit(dictionary, FitMetric::cubeRoot, 5);
            e[9] = fit(dictionary, FitMetric::cubeRoot, 0);
            for (size_t m = 0; m < methods; ++m) radiance[m].push_back(e[m].first), cube[m].push_back(e[m].second);
            std::printf("%-28s", material.c_str());
            for (const size_t m : {0, 1, 2, 5, 7}) std::printf("   %6.3f / %5.3f", e[m].first, e[m].second);
            std::puts("");
        }
        std::printf(
            "\n%zu materials                    relative L2: median, 90 %%, worst      cube root: median, 90 %%, "
            "worst\n",
            networks.size());
        for (size_t m = 0; m < methods; ++m)
            std::printf("%-32s %6.3f %6.3f %6.3f                    %6.4f %6.4f %6.4f\n", names[m],
                        quantile(radiance[m], 0.5), quantile(radiance[m], 0.9), quantile(radiance[m], 1),
                        quantile(cube[m], 0.5), quantile(cube[m], 0.9), quantile(cube[m], 1));
        std::printf("lobes in use of the whole dictionary: median %.0f\n", quantile(lobes, 0.5));
        for (int i = 2; i < argc; ++i) {
            const MeasuredBrdf read = readMerl(argv[i]);
            const std::string material = read.name.substr(0, read.name.find('.'));
            const auto row = networks.find(material);
            if (row == networks.end()) throw Error("{}: is in no table", material);
            std::vector<Rgb> values, looked;
            for (const BrdfSample& s : samples) {
                values.push_back(network(row->second)(s.towardLight, s.towardEye));
                looked.push_back(read.evaluate(s.towardLight, s.towardEye));
            }
            const auto [l2, cubeRoot] = brdfErrors(samples, values, looked);
            std::printf("%s: read and interpolated, against its network: relative L2 %.4f, cube root %.5f\n",
                        material.c_str(), l2, cubeRoot);
        }
        return 0;
    } catch (const std::exception& error) { return std::fprintf(stderr, "brdf_fit: %s\n", error.what()), 1; }
}
