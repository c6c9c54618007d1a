// IPOPT in the race: an interior point method, the package most people would reach for.
#include "bench/race_contestants.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wshadow"
#include <IpIpoptApplication.hpp>
#include <IpTNLP.hpp>
#pragma GCC diagnostic pop

namespace relamp::bench {
namespace {

using Ipopt::Index;
using Ipopt::Number;

class Program : public Ipopt::TNLP {
public:
    Program(const RaceProblem& problem, Recorder& record) : s_(problem), record_(record) {}
    bool get_nlp_info(Index& n, Index& m, Index& jacobian, Index& hessian, IndexStyleEnum& style) override {
        n = Index(s_.b.size());
        m = jacobian = 0;
        hessian = n * (n + 1) / 2;
        style = C_STYLE;
        return true;
    }
    bool get_bounds_info(Index n, Number* low, Number* high, Index, Number*, Number*) override {
        std::fill(low, low + n, 0.0);
        std::fill(high, high + n, 1e20);
        return true;
    }
    bool get_starting_point(Index n, bool, Number* x, bool, Number*, Number*, Index, bool, Number*) override {
        std::fill(x, x + n, 1.0 / double(n));
        return true;
    }
    bool eval_f(Index n, const Number* x, bool, Number& value) override {
        const Eigen::Map<const Eigen::VectorXd> at(x, n);
        value = 0.5 * at.dot(product(at)) - s_.b.dot(at);
        record_(s_.scale.cwiseProduct(at));
        return true;
    }
    bool eval_grad_f(Index n, const Number* x, bool, Number* gradient) override {
        const Eigen::Map<const Eigen::VectorXd> at(x, n);
        Eigen::Map<Eigen::VectorXd>(gradient, n) = product(at) - s_.b;
        return true;
    }
    bool eval_g(Index, const Number*, bool, Index, Number*) override { return true; }
    bool eval_jac_g(Index, const Number*, bool, Index, Index, Index*, Index*, Number*) override { return true; }
    bool eval_h(Index n, const Number*, bool, Number factor, Index, const Number*, bool, Index, Index* rows,
                Index* columns, Number* values) override {
        Index at = 0;
        for (Index j = 0; j < n; ++j)
            for (Index i = j; i < n; ++i, ++at) {
                if (values) values[at] = factor * s_.a(i, j);
                else rows[at] = i, columns[at] = j;
            }
        return true;
    }
    bool intermediate_callback(Ipopt::AlgorithmMode, Index, Number, Number, Number, Number, Number, Number, Number,
                               Number, Index, const Ipopt::IpoptData*, Ipopt::IpoptCalculatedQuantities*) override {
        return !record_.stop();
    }
    void finalize_solution(Ipopt::SolverReturn, Index n, const Number* x, const Number*, const Number*, Index,
                           const Number*, const Number*, Number, const Ipopt::IpoptData*,
                           Ipopt::IpoptCalculatedQuantities*) override {
        record_(s_.scale.cwiseProduct(Eigen::Map<const Eigen::VectorXd>(x, n)));
    }

private:
    ScaledProblem s_;
    Recorder& record_;
    Eigen::VectorXd last_, lastProduct_;
    /// A x, once for value and gradient at the same point.
    const Eigen::VectorXd& product(const Eigen::Map<const Eigen::VectorXd>& at) {
        if (last_.size() != at.size() || last_ != at) {
            last_ = at;
            lastProduct_ = s_.a * last_;
        }
        return lastProduct_;
    }
};

}  // namespace

void ipopt(const RaceProblem& problem, Recorder& record, bool limitedMemory) {
    Ipopt::SmartPtr<Ipopt::TNLP> program = new Program(problem, record);
    Ipopt::SmartPtr<Ipopt::IpoptApplication> application = IpoptApplicationFactory();
    application->Options()->SetIntegerValue("print_level", 0);
    application->Options()->SetStringValue("sb", "yes");
    application->Options()->SetStringValue("hessian_constant", "yes");
    application->Options()->SetStringValue("mu_strategy", "adaptive");
    application->Options()->SetNumericValue("tol", 1e-10);
    if (limitedMemory) {
        application->Options()->SetStringValue("hessian_approximation", "limited-memory");
        application->Options()->SetIntegerValue("limited_memory_max_history", 20);
        application->Options()->SetIntegerValue("max_iter", 100000);
    }
    application->Initialize();
    application->OptimizeTNLP(program);
}

}  // namespace relamp::bench
