// A reader that is fed with anything. Each target is a function of bytes that registers itself by name; replay.cpp runs
// them on the corpus and on mutations of it, libFuzzer (libfuzzer.cpp) on what it makes up. A relamp::Error is a good
// answer; whatever else is thrown is a finding.
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

namespace relamp::fuzz {

using Run = void (*)(std::string_view bytes);

/// Runs `bytes` through the target; whether it was read to its end. Throws what is no relamp::Error; std::out_of_range
/// when there is no such target.
bool runTarget(const std::string& target, std::string_view bytes);
const std::map<std::string, Run>& targets();

struct Target {
    Target(const char* name, Run run);
};

/// A folder of this process, in memory where there is such a place; gone when it ends.
const std::filesystem::path& folder();
/// A file in it with these bytes.
std::filesystem::path fileWith(const std::string& name, std::string_view bytes);
/// The bytes in `count` parts: what stands between lines of "=====". Missing parts are empty.
std::string_view part(std::string_view bytes, size_t index);

}  // namespace relamp::fuzz
