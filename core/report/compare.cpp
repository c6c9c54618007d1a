#include "report/compare.h"
namespace relamp {
std::filesystem::path writeComparison(const std::filesystem::path&, const std::filesystem::path& folder, const CompareOptions&, Progress&) { return folder; }
}
