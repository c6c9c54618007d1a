// Long work of the core for a Python caller: on a thread of its own, while the caller's tells how far it is.
#pragma once
#include <pybind11/pybind11.h>

#include <exception>
#include <functional>

#include "base/progress.h"

namespace relamp::python {

/// Runs `work` with the interpreter free. `tell`, if not None, is called with a label and a fraction about ten times a
/// second, on the caller's thread; where it returns False the work is stopped. So do Ctrl+C and exceptions of `tell`,
/// which then leave this function. Throws what `work` throws, Cancelled where `tell` stopped it.
void runJob(const pybind11::object& tell, Progress& progress, const std::function<void()>& work);

}  // namespace relamp::python
