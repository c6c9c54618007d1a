// The race: our bounded quadratic solver against a textbook active set, projected gradients, FISTA and IPOPT on the
// same lighting programs. CPU seconds, one thread each, to 1 % and to 0.1 % above the best objective that any of them
// found.
//   race [--limit SECONDS] [--levels 4,5,6]
#include <cstdio>
#include <cstring>

#include "base/parallel.h"
#include "bench/race_contestants.h"
#include "solve/light/qp.h"

namespace relamp::bench {
namespace {

struct Contestant {
    const char* name;
    std::function<void(const RaceProblem&, Recorder&)> run;
};

void ours(const RaceProblem& p, Recorder& record) {
    QpWatch watch;
    watch.each = [&](const Eigen::VectorXd& x) { record(x); };
    const QpResult r = solveBoundedQp(p.q, p.c, Eigen::VectorXd::Zero(p.c.size()), nullptr, watch);
    record(r.x);
    if (p.c.size() > 2048)
        std::printf("  (relamp: %.2f s to the end, %d factors, relative KKT residual %.1e, %d of %d above zero)\n",
                    record.seconds(), r.iterations, r.kktResidual, int((r.x.array() > 0).count()), int(r.x.size()));
}

std::string secondsText(double s) { return std::isfinite(s) ? fmt::format("{:.4g}", s) : std::string("not finished"); }

void race(const RaceProblem& problem, double limit) {
    std::printf("%s, at most %g CPU seconds each\n", problem.name.c_str(), limit);
    std::vector<Contestant> contestants{{"relamp", ours},
                                        {"Lawson-Hanson", lawsonHanson},
                                        {"projected gradient", projectedGradient},
                                        {"FISTA, restarted", fista}};
#ifdef RELAMP_RACE_IPOPT
    contestants.push_back({"IPOPT", [](const RaceProblem& p, Recorder& r) { ipopt(p, r, false); }});
    contestants.push_back({"IPOPT, limited memory", [](const RaceProblem& p, Recorder& r) { ipopt(p, r, true); }});
#endif
    std::vector<Recorder> records;
    double best = 1e300;
    // What takes milliseconds is run several times, by everyone; the fastest run counts.
    const int repeats = problem.c.size() < 512 ? 9 : problem.c.size() < 2048 ? 3 : 1;
    for (const Contestant& c : contestants) {
        std::vector<Recorder> runs;
        for (int k = 0; k < repeats && (k == 0 || runs[0].seconds() < 1); ++k) {
            runs.emplace_back(problem, limit);
            if (best < 1e300) runs.back().goal(best * (1 + 2e-4));
            c.run(problem, runs.back());
            runs.back().finish();
        }
        size_t fastest = 0;
        for (size_t k = 1; k < runs.size(); ++k)
            if (runs[k].secondsTo(runs[k].best() * 1.0005) < runs[fastest].secondsTo(runs[fastest].best() * 1.0005))
                fastest = k;
        records.push_back(runs[fastest]);
        best = std::min(best, records.back().best());
    }
    std::printf("  %-24s %12s %12s %14s\n", "", "s to 1 %", "s to 0.1 %", "best, relative");
    double other[2] = {1e300, 1e300};
    for (size_t i = 0; i < contestants.size(); ++i) {
        const double one = records[i].secondsTo(best * 1.01), tenth = records[i].secondsTo(best * 1.001);
        std::printf("  %-24s %12s %12s %14.1e\n", contestants[i].name, secondsText(one).c_str(),
                    secondsText(tenth).c_str(), records[i].best() / best - 1);
        if (i > 0) other[0] = std::min(other[0], one), other[1] = std::min(other[1], tenth);
    }
    std::printf("  best other / relamp      %12.1f %12.1f\n\n", other[0] / records[0].secondsTo(best * 1.01),
                other[1] / records[0].secondsTo(best * 1.001));
    std::fflush(stdout);
}

}  // namespace
}  // namespace relamp::bench

int main(int argc, char** argv) {
    using namespace relamp::bench;
    double limit = 60;
    std::string levels = "4,5,6";
    for (int i = 1; i + 1 < argc; ++i) {
        if (!std::strcmp(argv[i], "--limit")) limit = std::atof(argv[i + 1]);
        if (!std::strcmp(argv[i], "--levels")) levels = argv[i + 1];
    }
    for (char level : levels) {
        if (level < '1' || level > '7') continue;
        for (bool stiff : {false, true}) {
            const RaceProblem problem = makeRaceProblem(level - '0', stiff);
            const relamp::ThreadLimit one(1);
            race(problem, limit);
        }
    }
}
