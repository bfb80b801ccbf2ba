// What an observer sees who flips between two pictures: the FLIP metric.
//
// P. Andersson, J. Nilsson, T. Akenine-Moeller, M. Oskarsson, K. Astroem, M. D. Fairchild, "FLIP: A Difference
// Evaluator for Alternating Images", Proc. ACM Comput. Graph. Interact. Tech. 3(2), HPG 2020. This is LDR-FLIP, written
// from the paper; the numbers in flip.cpp are its.
#pragma once

#include "study/picture/image_error.h"

#include <vector>

namespace stratum::study {

/// Of the paper: 0.7 m from a monitor 0.7 m wide with 3840 pixels, about 67 pixels a degree.
extern const double kFlipPixelsPerDegree;

/// One value a pixel, 0 (no difference) to 1; symmetric in the pictures. Parallel over rows, the same for any number of
/// threads. std::invalid_argument for pictures of different sizes.
/// @param pixels_per_degree  of the observer's visual angle
std::vector<float> flipMap(const DisplayPicture& reference, const DisplayPicture& picture,
                           double pixels_per_degree = kFlipPixelsPerDegree);

/// Its mean.
double meanFlip(const DisplayPicture& reference, const DisplayPicture& picture,
                double pixels_per_degree = kFlipPixelsPerDegree);

}  // namespace stratum::study
