#include "option_rules.h"

#include <CLI/CLI.hpp>

#include <charconv>
#include <cmath>
#include <cstdlib>

namespace relamp::cli {
namespace {

/// "nan", "inf", and whole numbers that the type cannot hold, which the parser takes for its largest one.
void refuseBeyondNumbers(const CLI::Option& option, const std::string& value) {
    if (option.get_type_name().starts_with("FLOAT") && !std::isfinite(std::strtof(value.c_str(), nullptr)))
        throw CLI::ValidationError(option.get_name(), "is " + value + ", expected a finite number");
    uint64_t number = 0;
    if (option.get_type_name().starts_with("UINT") &&
        std::from_chars(value.data(), value.data() + value.size(), number).ec == std::errc::result_out_of_range)
        throw CLI::ValidationError(option.get_name(), "is " + value + ", which is too large");
}

}  // namespace

void refuseEmpty(const CLI::App& verb) {
    for (const CLI::Option* option : verb.get_options())
        for (const std::string& value : option->results())
            if (value.empty() && option->get_expected_min() > 0)
                throw CLI::ValidationError(option->get_name(), "the value is empty");
            else refuseBeyondNumbers(*option, value);
}

}  // namespace relamp::cli
