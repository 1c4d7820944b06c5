"""What media are, in pure Python: parameters, presets, spectra, dispersion, the contract with the shader; files."""
