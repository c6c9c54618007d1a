// The linear equations of one channel of log albedo, which the albedo step solves and the test of its prior's strength
// probes.
#pragma once
#include <Eigen/SparseCore>

#include "solve/albedo/albedo_step.h"

namespace relamp {

/// The quadratic model of one channel about `logAlbedo` (per mesh vertex): matrix x = moment.
struct AlbedoSystem {
    Eigen::SparseMatrix<double> matrix;
    Eigen::VectorXd moment;
    std::vector<double> precision;  ///< per observation: what it adds to its vertex's diagonal
    std::vector<float> own;         ///< per mesh vertex: fraction of that in its diagonal
};
AlbedoSystem albedoSystem(const Scene& scene, const MatteObservations& matte, const std::vector<Rgb>& lit,
                          const std::vector<Rgb>& litSigma, const AlbedoPrior& prior, const std::vector<Rgb>& logAlbedo,
                          double edge, double typical, int channel);

}  // namespace relamp
