#include "job.h"

#include <chrono>
#include <future>

namespace relamp::python {
namespace py = pybind11;

void runJob(const py::object& tell, Progress& progress, const std::function<void()>& work) {
    std::future<void> job = std::async(std::launch::async, work);
    std::exception_ptr raised;
    const auto isDone = [&] {
        const py::gil_scoped_release free;
        return job.wait_for(std::chrono::milliseconds(100)) == std::future_status::ready;
    };
    while (!isDone()) {
        if (raised || progress.stopRequested()) continue;
        try {
            if (PyErr_CheckSignals() != 0) throw py::error_already_set();
            if (tell.is_none()) continue;
            const py::object answer = tell(progress.label(), progress.fraction());
            if (py::isinstance<py::bool_>(answer) && !answer.cast<bool>()) progress.requestStop();
        } catch (...) {
            raised = std::current_exception();
            progress.requestStop();
        }
    }
    if (!raised) return job.get();
    try {
        job.get();
    } catch (...) {}  // it was stopped because of what was raised
    std::rethrow_exception(raised);
}

}  // namespace relamp::python
