// Runs targets without libFuzzer: every file of the corpus, then a fixed number of seeded mutations of them. What a
// target throws that is no relamp::Error ends the run, with the input kept; so does a corpus none of which is good any
// more, because its mutations would not get past the first lines.
//
//   relamp_fuzz TARGET CORPUS [MUTATIONS [SEED]]
//   relamp_fuzz all CORPORA [MUTATIONS [SEED]]: every target, on the folder of its name
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <functional>
#include <random>
#include <sstream>
#include <vector>

#include "base/parallel.h"
#include "fuzz/target.h"

namespace {
namespace fs = std::filesystem;

std::string read(const fs::path& file) {
    std::ostringstream bytes;
    bytes << std::ifstream(file, std::ios::binary).rdbuf();
    return bytes.str();
}

class Mutator {
public:
    Mutator(std::vector<std::string> seeds, unsigned seed) : seeds_(std::move(seeds)), random_(seed) {}

    std::string next() {
        std::string bytes = seeds_[below(seeds_.size())];
        for (size_t steps = 1 + below(6); steps > 0; --steps) change(bytes);
        if (bytes.size() > 1 << 16) bytes.resize(1 << 16);
        return bytes;
    }

private:
    size_t below(size_t n) { return n ? std::uniform_int_distribution<size_t>(0, n - 1)(random_) : 0; }

    void change(std::string& bytes) {
        static const std::vector<std::string> words{"0",
                                                    "-1",
                                                    "1e308",
                                                    "-1e-320",
                                                    "nan",
                                                    "inf",
                                                    "4294967295",
                                                    "18446744073709551615",
                                                    "99999999999999999999999",
                                                    "null",
                                                    "[]",
                                                    "{}",
                                                    "\"\"",
                                                    "true",
                                                    "\n",
                                                    " ",
                                                    "\r\n",
                                                    "#",
                                                    ",",
                                                    std::string(1, '\0'),
                                                    std::string(4, '\xff'),
                                                    std::string(8, '\xff'),
                                                    std::string("\0\0\x80\x7f", 4)};
        const size_t at = below(bytes.size() + 1);
        switch (below(8)) {
            case 0:
                if (!bytes.empty()) bytes[below(bytes.size())] ^= char(1 << below(8));
                break;
            case 1:
                if (!bytes.empty()) bytes[below(bytes.size())] = char(below(256));
                break;
            case 2: bytes.erase(at, 1 + below(16)); break;
            case 3: bytes.insert(at, words[below(words.size())]); break;
            case 4: bytes.insert(at, bytes.substr(below(bytes.size() + 1), 1 + below(64))); break;
            case 5: bytes.resize(at); break;
            case 6: {  // a number becomes another one
                const size_t digit = bytes.find_first_of("0123456789", at);
                if (digit == std::string::npos) break;
                const size_t end = std::min(bytes.find_first_not_of("0123456789.eE+-", digit), bytes.size());
                bytes.replace(digit, end - digit, words[below(9)]);
                break;
            }
            default: {  // the end of another seed
                const std::string& other = seeds_[below(seeds_.size())];
                bytes = bytes.substr(0, at) + other.substr(below(other.size() + 1));
            }
        }
    }

    std::vector<std::string> seeds_;
    std::mt19937 random_;
};

/// Runs one input; false when the target threw. Counts in `whole` what was read to its end.
bool good(const std::string& target, const std::string& bytes, const std::string& from, size_t& whole) {
    try {
        whole += relamp::fuzz::runTarget(target, bytes);
        return true;
    } catch (const std::exception& error) {
        const fs::path kept = fs::temp_directory_path() / ("relamp-fuzz-" + target);
        std::ofstream(kept, std::ios::binary) << bytes;
        std::fprintf(stderr, "%s: %s throws \"%s\"; the input is kept in %s\n", target.c_str(), from.c_str(),
                     error.what(), kept.c_str());
        return false;
    }
}

/// False when there was a finding, or when the corpus tests little.
bool runCorpus(const std::string& target, const fs::path& corpus, int mutations, unsigned seed) {
    if (target == "merl") mutations /= 3;  // files of 35 MB
    std::vector<std::string> seeds;
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(corpus)) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    size_t whole = 0, wholeMutations = 0;
    for (const fs::path& file : files) {
        seeds.push_back(read(file));
        if (!good(target, seeds.back(), file.string(), whole)) return false;
    }
    if (seeds.empty()) {
        std::fprintf(stderr, "%s: no seeds in %s\n", target.c_str(), corpus.c_str());
        return false;
    }
    if (whole == 0) {
        std::fprintf(stderr, "%s: none of %zu files in %s is read to its end, so they test little\n", target.c_str(),
                     seeds.size(), corpus.c_str());
        return false;
    }
    Mutator mutator(seeds, seed);
    for (int i = 0; i < mutations; ++i)
        if (!good(target, mutator.next(), "mutation " + std::to_string(i), wholeMutations)) return false;
    std::printf("%s: %zu files, %zu of them good; %d mutations, %zu of them good\n", target.c_str(), seeds.size(),
                whole, mutations, wholeMutations);
    return true;
}

/// In a process of its own, so that targets share no files and a crash is one target's. True when it ended well.
bool endsWell(const std::function<bool()>& part) {
    const pid_t child = fork();
    if (child == 0) {
        const bool good = part();
        std::error_code ignored;
        fs::remove_all(relamp::fuzz::folder(), ignored);
        std::fflush(nullptr);
        _exit(good ? 0 : 1);  // not the libraries' ends, which may wait for threads of the first process
    }
    int status = 1;
    return child > 0 && waitpid(child, &status, 0) == child && status == 0;
}

}  // namespace

int main(int argc, char** argv) {
    const bool all = argc > 1 && std::string(argv[1]) == "all";
    if (argc < 3 || (!all && !relamp::fuzz::targets().count(argv[1]))) {
        std::fputs("relamp_fuzz TARGET CORPUS [MUTATIONS [SEED]]; targets: all", stderr);
        for (const auto& [name, run] : relamp::fuzz::targets()) std::fprintf(stderr, " %s", name.c_str());
        std::fputc('\n', stderr);
        return 2;
    }
    const int mutations = argc > 3 ? std::atoi(argv[3]) : 0;
    const unsigned seed = argc > 4 ? unsigned(std::atoi(argv[4])) : 1;
#ifndef RELAMP_SANITIZED
    // Memory that a small file asks for is a finding: then a std::bad_alloc comes.
    const rlimit limit{rlim_t(3) << 30, rlim_t(3) << 30};
    setrlimit(RLIMIT_AS, &limit);
#endif
    const auto run = [&](const std::string& target, const fs::path& corpus) {
        const relamp::ThreadLimit oneThread(1);
        return runCorpus(target, corpus, mutations, seed);
    };
    if (!all) return run(argv[1], argv[2]) ? 0 : 1;
    int findings = 0;
    for (const auto& entry : fs::directory_iterator(argv[2]))
        if (!relamp::fuzz::targets().count(entry.path().filename())) {
            std::fprintf(stderr, "%s: no target has this name\n", entry.path().c_str());
            ++findings;
        }
    for (const auto& [name, target] : relamp::fuzz::targets())
        if (!endsWell([&, target = name] { return run(target, fs::path(argv[2]) / target); })) {
            std::fprintf(stderr, "%s: did not end well\n", name.c_str());
            ++findings;
        }
    return findings == 0 ? 0 : 1;
}
