function options = weboptions (varargin)
  % Name and value pairs as MATLAB has them; Octave's own does not know MediaType.
  options = struct ("Timeout", 5, "MediaType", "application/json", varargin{:});
end
