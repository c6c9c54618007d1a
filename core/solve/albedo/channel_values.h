// The three colour channels as one number of Eigen's: equations that differ between channels by their diagonal alone
// are factored once.
#pragma once
#include <Eigen/Core>

namespace relamp {

/// Every operation is done channel by channel. A fourth value, the third again, fills the processor's registers.
struct ChannelValues {
    double of[4];

    ChannelValues() : ChannelValues(0.0) {}
    ChannelValues(double all) : of{all, all, all, all} {}
    ChannelValues(double r, double g, double b) : of{r, g, b, b} {}
    double operator[](int c) const { return of[c]; }

    ChannelValues& operator+=(const ChannelValues& o) {
        return each(o, [](double& a, double b) { a += b; });
    }
    ChannelValues& operator-=(const ChannelValues& o) {
        return each(o, [](double& a, double b) { a -= b; });
    }
    ChannelValues& operator*=(const ChannelValues& o) {
        return each(o, [](double& a, double b) { a *= b; });
    }
    ChannelValues& operator/=(const ChannelValues& o) {
        return each(o, [](double& a, double b) { a /= b; });
    }
    friend ChannelValues operator+(ChannelValues a, const ChannelValues& b) { return a += b; }
    friend ChannelValues operator-(ChannelValues a, const ChannelValues& b) { return a -= b; }
    friend ChannelValues operator*(ChannelValues a, const ChannelValues& b) { return a *= b; }
    friend ChannelValues operator/(ChannelValues a, const ChannelValues& b) { return a /= b; }
    friend ChannelValues operator-(const ChannelValues& a) { return ChannelValues(0.0) - a; }
    friend bool operator==(const ChannelValues&, const ChannelValues&) = default;
    /// In some channel, as a pivot that ends a factorisation.
    friend bool operator<=(const ChannelValues& a, const ChannelValues& b) {
        return a.of[0] <= b.of[0] || a.of[1] <= b.of[1] || a.of[2] <= b.of[2];
    }
    friend ChannelValues sqrt(const ChannelValues& a) {
        return {std::sqrt(a.of[0]), std::sqrt(a.of[1]), std::sqrt(a.of[2])};
    }

private:
    template <class Operation>
    ChannelValues& each(const ChannelValues& o, const Operation& operation) {
        for (int i = 0; i < 4; ++i) operation(of[i], o.of[i]);
        return *this;
    }
};

}  // namespace relamp

template <>
struct Eigen::NumTraits<relamp::ChannelValues> : Eigen::GenericNumTraits<relamp::ChannelValues> {
    using Real = relamp::ChannelValues;
    using NonInteger = relamp::ChannelValues;
    using Nested = relamp::ChannelValues;
    using Literal = double;
    enum {
        IsComplex = 0,
        IsInteger = 0,
        IsSigned = 1,
        RequireInitialization = 1,
        ReadCost = 4,
        AddCost = 4,
        MulCost = 4
    };
};
