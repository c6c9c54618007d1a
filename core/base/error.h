// The one exception of the core, with context added on the way up, and the tag thrown when a job is cancelled.
#pragma once
#include <fmt/format.h>

#include <stdexcept>
#include <string>

namespace relamp {

/// Bad input, failed I/O or numbers that went bad: one sentence a user can act on.
/// The message reads "FILE: FIELD: what is wrong, what was expected".
class Error : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
    template <class... Args>
    explicit Error(fmt::format_string<Args...> format, Args&&... args) requires(sizeof...(Args) > 0)
        : std::runtime_error(fmt::format(format, std::forward<Args>(args)...)) {}

    /// The same error with `context` (a file, a frame) put before it.
    Error in(const std::string& context) const { return Error(std::string(context + ": " + what())); }
};

/// The disk, the memory or the budget ran out with nothing to show (exit code 6).
class OutOfResources : public Error {
public:
    using Error::Error;
};

/// Thrown by Progress when the user stops a job. Not an error: the inputs are untouched.
struct Cancelled {};

/// Thrown by Progress inside a stage that can be given up, when the time budget is used up: what was best before it
/// stays.
struct OutOfTime {};

/// Runs `body`; an Error that leaves it gets `context` in front.
template <class Body>
auto withContext(const std::string& context, Body&& body) {
    try {
        return body();
    } catch (const OutOfResources& error) {
        throw OutOfResources(context + ": " + error.what());
    } catch (const Error& error) { throw error.in(context); }
}

}  // namespace relamp
