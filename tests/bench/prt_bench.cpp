// What an edit costs: milliseconds per kind of edit and number of vertices, beside the bandwidth of memory measured in
// the same run, brute force on the grid and published rates. tests/bench/run builds it, runs it and prints the table.
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "bench/prt_stage.h"

namespace relamp::bench {
namespace {

void add(const std::string& name, int iterations, std::function<void(benchmark::State&)> part) {
    benchmark::RegisterBenchmark(name.c_str(), std::move(part))
        ->UseManualTime()
        ->Iterations(iterations)
        ->Unit(benchmark::kMillisecond);
}

void registerAll(bool large) {
    add("copy", 7, copyRate);
    std::vector<size_t> sizes{10000, 50000};
    if (large) sizes.insert(sizes.end(), {200000, 1000000});
    for (size_t n : sizes) {
        const std::string k = "/" + sizeName(n);
        if (n != 200000) add("bake cached" + k, 1, [n](benchmark::State& s) { bakeCached(s, n); });
        add("bake" + k, 1, [n](benchmark::State& s) { bake(s, n); });
        if (n == 50000) add("rays", 3, [n](benchmark::State& s) { rayRate(s, n); });
        add("environment" + k, 9, [n](benchmark::State& s) { environment(s, n); });
        add("exposure" + k, 9, [n](benchmark::State& s) { exposure(s, n); });
        add("power" + k, 9, [n](benchmark::State& s) { power(s, n); });
        add("drag" + k, 7, [n](benchmark::State& s) { drag(s, n, false, 1); });
        if (n == 50000) add("drag large light" + k, 5, [n](benchmark::State& s) { drag(s, n, false, 3); });
        add("brute force" + k, 3, [n](benchmark::State& s) { bruteForce(s, n); });
    }
    for (size_t n : sizes) {
        if (n > 200000) continue;
        const std::string k = "/" + sizeName(n);
        add("eye" + k, 7, [n](benchmark::State& s) { eye(s, n); });
        if (n == 50000) add("glossy paths" + k, 1, [n](benchmark::State& s) { glossyPaths(s, n); });
        add("drag glossy" + k, 5, [n](benchmark::State& s) { drag(s, n, true, 1); });
    }
    add("compression/10k", 1, [](benchmark::State& s) { compression(s, 10000); });
    add("cells/10k", 1, [](benchmark::State& s) { cells(s, 10000); });
}

/// One table: a row a kind of edit, a column a number of vertices; processor time over cores in brackets.
void printTable(bool large) {
    std::vector<std::string> sizes{"10k", "50k"};
    if (large) sizes.insert(sizes.end(), {"200k", "1M"});
    const auto row = [&](const std::string& what, const std::string& key, double scale = 1) {
        bool any = false;
        std::string line = fmt::format("{:<52}", what);
        for (const std::string& n : sizes) {
            const auto at = measured.find(key + n), processor = measured.find(key + n + "_processor");
            any |= at != measured.end();
            std::string cell = at == measured.end() ? "-" : fmt::format("{:.3g}", scale * at->second);
            if (processor != measured.end()) cell += fmt::format(" ({:.3g})", scale * processor->second);
            line += fmt::format("{:>20}", cell);
        }
        if (any) std::printf("%s\n", line.c_str());
    };
    std::string head = fmt::format("\n{:<52}", "vertices");
    for (const std::string& n : sizes) head += fmt::format("{:>20}", n);
    std::printf("%s\n", head.c_str());
    for (const auto& [n, vertices] :
         {std::pair("10k", 1e4), std::pair("50k", 5e4), std::pair("200k", 2e5), std::pair("1M", 1e6)})
        measured[std::string("ng04_published_ms_") + n] = 4000 * vertices / 3e5;
    row("bake, s", "bake_s_");
    row("  while its file is written, s", "bake_streamed_s_");
    row("  found in the cache, s", "bake_cached_s_");
    row("environment: light of all vertices, ms", "env_swap_ms_");
    row("  its bytes at copy bandwidth, ms", "env_copy_limit_ms_");
    row("  best run, ms", "env_swap_best_ms_");
    row("  best run over that limit", "env_swap_over_copy_limit_");
    row("  brute force on the grid, ms", "env_brute_force_ms_");
    row("  times faster", "over_brute_force_");
    row("  turned, the whole edit, ms", "env_edit_ms_");
    row("exposure, ms", "exposure_ms_");
    row("emitter power, ms", "power_change_ms_");
    row("emitter dragged, first image, ms", "drag_first_ms_");
    row("  off by, %", "drag_first_error_", 100);
    row("  within 1 % after, s", "drag_refined_s_");
    row("a light of a third of the scene dragged, ms", "drag_first_ms_large_lamp_");
    row("glossy scene, emitter dragged, ms", "drag_first_ms_glossy_");
    row("glossy scene, eye moved, ms", "glossy_view_ms_");
    row("  image off by, %", "glossy_error_", 100);
    row("  its glossy part off by, %", "glossy_part_error_", 100);
    row("  refined after, s", "glossy_refined_s_");
    row("  brute force on the environment's cells, ms", "glossy_brute_force_ms_");
    row("[Ng04] published: 3-5 s at 300k, scaled, ms", "ng04_published_ms_");
    row("stored bytes a vertex", "bytes_per_vertex_");
    row("coefficients a vertex", "terms_per_vertex_");
    row("most memory so far, GiB", "peak_gib_");
    for (const char* name : {"copy_gb_s", "mrays_per_core_s", "cores"})
        if (measured.count(name)) std::printf("%-52s%20.3g\n", name, measured[name]);
    std::printf("\n");
    for (const auto& [name, value] : measured)
        if (name.starts_with("gloss_") || name.starts_with("compression_") || name.find("_side") != std::string::npos)
            std::printf("%-44s %.4g\n", name.c_str(), value);
}

}  // namespace
}  // namespace relamp::bench

int main(int argc, char** argv) {
    using namespace relamp;
    using namespace relamp::bench;
    std::string json;
    bool large = false;
    std::vector<char*> passed{argv[0]};
    for (int i = 1; i < argc; ++i) {
        if (!std::strcmp(argv[i], "--json") && i + 1 < argc) json = argv[++i];
        else if (!std::strcmp(argv[i], "--large")) large = true;
        else passed.push_back(argv[i]);
    }
    int count = int(passed.size());
    benchmark::Initialize(&count, passed.data());
    if (benchmark::ReportUnrecognizedArguments(count, passed.data())) return 2;
    registerAll(large);
    measured["cores"] = availableThreads();
    benchmark::RunSpecifiedBenchmarks();
    dropStage();
    if (measured.count("bytes_per_vertex_50k")) measured["bytes_per_vertex"] = measured["bytes_per_vertex_50k"];
    printTable(large);
    if (!json.empty()) {
        std::ofstream out(json);
        out << nlohmann::json(measured).dump(2) << "\n";
        if (!out) return 1;
    }
    return 0;
}
