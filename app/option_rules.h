// What no option may be given.
#pragma once

namespace CLI {
class App;
}

namespace relamp::cli {

/// A value that is empty comes from a variable that was not set, and means nothing that its absence does not. Nor may
/// numbers be infinite, none, or larger than their type. Throws CLI::ValidationError naming the option.
void refuseEmpty(const CLI::App& verb);

}  // namespace relamp::cli
